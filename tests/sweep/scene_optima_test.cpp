#include "trebsweep/sweep/scene_optima.hpp"

#include <array>
#include <cmath>

#include "support/archive_reader.hpp"
#include "support/catch.hpp"
#include "support/quiet_sweep.hpp"
#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

/// A study of 2 x 3 scenes whose lattices differ.
Job small_study(const TemporaryFile& file) {
  Job job;
  job.lattice.increment = 0.1;
  job.output.file = file.path();
  job.outer_axes = {{"scene.projectile-mass", {50, 100}, "50, 100"},
                    {"scene.fulcrum-height", {1.2, 1.25, 1.5}, "1.2, 1.25, 1.5"}};
  job.scene.projectile_mass = 50;
  job.scene.fulcrum_height = 1.2;
  return job;
}

/// The least tension of the sling by a function that integrates.
double least_tension(decltype(integrate_accurately) integrate_by, const Job& job,
                     const Design<double>& design) {
  constexpr std::array fields{Field::least_sling_tension};
  SwingResult result;
  double value = 0;
  integrate_by(job.scene, job.solver, {{&design, 1}, {&result, 1}, fields, {&value, 1}});
  return value;
}

void by_the_solver(const Scene& scene, const Solver& solver, const Batch& batch) {
  integrate(scene, solver, batch);
}

/// The best design of a lattice.
BestDesign best_at(const Design<double>& design, double value) {
  return to_best_design({value, value, design.r1, design.r3, design.r2, 1, BestDesign::nan});
}

constexpr Design<double> coarse{0.6, 0.6, 0.8}, between{0.55, 0.58, 0.9};

std::optional<BestDesign> no_refinement(const Job&, const Design<double>&) { return std::nullopt; }

}  // namespace

TEST_CASE("The optimum of a scene is the best design of its lattice, by the job's solver") {
  Job job;
  job.solver.tolerance = 1e-4;
  const BestDesign best = best_at(coarse, 15);
  BestDesign optimum = scene_optimum(job, best, {});
  CHECK(optimum.value == 15);
  CHECK(optimum.design == coarse);
  CHECK(optimum.build.least_sling_tension == least_tension(by_the_solver, job, coarse));
  SwingResult accurate{};
  integrate_accurately(job.scene, checking_solver(job.scene, job.solver),
                       {{&coarse, 1}, {&accurate, 1}});
  CHECK(optimum.error == std::abs(15 - accurate.speed));
  job.solver.check = false;
  optimum = scene_optimum(job, best, {});
  CHECK(std::isnan(optimum.error));
  CHECK(optimum.build.least_sling_tension == least_tension(by_the_solver, job, coarse));
}

TEST_CASE("The optimum of a scene is the refined one if there is one, integrated accurately") {
  Job job;
  job.solver.tolerance = 1e-4;
  job.optimum.refine = true;
  const double accurate = least_tension(integrate_accurately, job, between);
  CHECK(accurate != least_tension(by_the_solver, job, between));
  const Refine refine = [&](const Job&, const Design<double>& design) {
    CHECK(design == coarse);
    BestDesign refined = best_at(between, 16);
    refined.error = 1e-9;
    return refined;
  };
  BestDesign optimum = scene_optimum(job, best_at(coarse, 15), refine);
  CHECK(optimum.value == 16);
  CHECK(optimum.design == between);
  CHECK(optimum.error == 1e-9);
  CHECK(optimum.build.least_sling_tension == accurate);
  optimum = scene_optimum(job, best_at(coarse, 15), no_refinement);
  CHECK(optimum.value == 15);
  CHECK(optimum.design == coarse);
  CHECK(optimum.error > 0);
}

TEST_CASE("The optima of a study are each integrated in its own scene") {
  const TemporaryFile file("study");
  Job job = small_study(file);
  job.outer_axes = {{"scene.fulcrum-height", {1.6, 1.7, 1.8, 1.9}, "1.6:1.9:0.1"}};
  job.lattice.r1 = AxisRange{0.8, 0.8, 1};
  const Summary summary = summary_of(job);
  REQUIRE(summary.optima.size() == 4);
  for (std::uint64_t scene = 0; scene < 4; ++scene) {
    const Job own = job_at(job, scene);
    const BestDesign& optimum = summary.optima[scene];
    CHECK(optimum.build.least_sling_tension == least_tension(by_the_solver, own, optimum.design));
    CHECK(optimum.build.counterweight_clearance ==
          Approx(own.scene.fulcrum_height - 0.8).margin(1e-6));
    SwingResult accurate{};
    integrate_accurately(own.scene, checking_solver(own.scene, own.solver),
                         {{&optimum.design, 1}, {&accurate, 1}});
    CHECK(optimum.error == std::abs(optimum.speed - accurate.speed));
    CHECK(optimum.error < 1e-4);
  }
}

TEST_CASE("A scene's slice of a study is bitwise the sweep of that scene alone") {
  const TemporaryFile file("study"), alone("scene");
  const Job job = small_study(file);
  const Study study(job);
  for (const Index3& edge : {Index3{16, 16, 16}, Index3{4, 3, 5}}) {
    const Summary summary = summary_of(job, quiet(edge));
    CHECK(summary.tally.designs() == study.designs());
    REQUIRE(summary.optima.size() == study.scenes());
    for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
      Job single = job_at(job, scene);
      single.output.file = alone.path();
      const Summary own = summary_of(single);
      const auto numbers = to_numbers(summary.optima[scene]), expected = to_numbers(best_of(own));
      CHECK(std::equal(numbers.begin(), numbers.end(), expected.begin(), same_bits));
      if (!root()) continue;
      const Lattice lattice(single.scene, single.lattice), &box = study.lattice(scene);
      for (const char* name : {"speed", "release_time", "status"}) {
        const auto whole = read_map(file.path(), name), slice = read_map(alone.path(), name);
        std::uint64_t designs = 0, wrong = 0;
        const Index3 n = study.extent(), n_own = lattice.extent();
        for (std::size_t a = 0; a < n[0]; ++a)
          for (std::size_t b = 0; b < n[1]; ++b)
            for (std::size_t c = 0; c < n[2]; ++c) {
              const double value = whole[study.cell(scene, {a, b, c})];
              if (!box.holds({a, b, c})) {
                wrong += !(name == std::string("status") ? value == 0 : std::isnan(value));
                continue;
              }
              const Index3 i = lattice.index_of(box.design({a, b, c}));
              wrong += !same_bits(value, slice[(i[0] * n_own[1] + i[1]) * n_own[2] + i[2]]);
              ++designs;
            }
        CHECK(designs == lattice.designs());
        CHECK(wrong == 0);
      }
    }
  }
}

TEST_CASE("Without maps a study stores the optima of its scenes, with their errors, and no map") {
  const TemporaryFile file("study"), without("without");
  Job job = small_study(file);
  const Summary with_maps = summary_of(job);
  job.output.file = without.path();
  job.output.maps = Maps::none;
  const Summary summary = summary_of(job);
  CHECK(summary.tally.statuses == with_maps.tally.statuses);
  if (!root()) return;
  CHECK_THROWS(read_map(without.path(), "speed"));
  for (const std::string_view name : best_names) {
    const auto a = read_map(file.path(), std::string(name)),
               b = read_map(without.path(), std::string(name));
    REQUIRE(a.size() == 6);
    CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end(), same_bits));
  }
  CHECK(read_map(without.path(), "best_error")[4] == summary.optima[4].error);
}

TEST_CASE("With refine, the optimum of each scene is what the function finds for it") {
  const TemporaryFile file("study");
  Job job = small_study(file);
  job.output.maps = Maps::none;
  job.optimum.refine = true;
  SweepOptions options = quiet();
  options.refine = [](const Job& single, const Design<double>& design) {
    CHECK(single.outer_axes.empty());
    const double value = single.scene.projectile_mass + single.scene.fulcrum_height;
    return to_best_design({value, 3, design.r1, design.r3, 0.07, 4, 5});
  };
  const Summary summary = summary_of(job, options);
  CHECK(summary.best() == 5u);
  CHECK(best_of(summary).value == 101.5);
  if (!root()) return;
  const Summary stored = read_contents(file.path()).summary;
  CHECK(stored.best() == 5u);
  CHECK(best_of(stored).value == 101.5);
  CHECK(read_map(file.path(), "best_value") ==
        std::vector<double>{51.2, 51.25, 51.5, 101.2, 101.25, 101.5});
  CHECK(read_map(file.path(), "best_r2") == std::vector<double>(6, 0.07));
  CHECK(read_map(file.path(), "best_error") == std::vector<double>(6, 5));
}

TEST_CASE("A scene without a release has no optimum, and the others have theirs") {
  const TemporaryFile file("study");
  Job job = small_study(file);
  job.outer_axes[0] = {"scene.pivot-friction", {0, 1e9}, "0, 1e9"};
  const Summary summary = summary_of(job);
  for (std::uint64_t scene = 0; scene < 6; ++scene)
    CHECK(summary.optima[scene].exists() == (scene < 3));
}

TEST_CASE("A study that is stopped again and again ends with the same archive as one in one go") {
  const TemporaryFile straight("straight"), stopped("stopped");
  const Index3 edge{4, 3, 5};
  const Summary expected = summary_of(small_study(straight), quiet(edge));
  const Job job = small_study(stopped);
  SweepOptions options = quiet(edge);
  options.overwrite = false;
  Summary summary;
  int runs = 0;
  do {
    int calls_left = runs == 0 ? 8 : 12 + 2 * runs;
    options.stop = [&] { return calls_left-- <= 0; };
    summary = summary_of(job, options);
    ++runs;
  } while (!summary.complete && runs < 200);
  CHECK(runs > 5);
  CHECK(summary.tally.statuses == expected.tally.statuses);
  CHECK(summary.best() == expected.best());
  if (!root()) return;
  for (const char* map : {"speed", "status", "projectile_mass", "fulcrum_height", "r1",
                          "best_speed", "best_r1", "best_error", "tile_block", "tile_designs"}) {
    const auto a = read_map(straight.path(), map), b = read_map(stopped.path(), map);
    CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end(), same_bits));
  }
}
