#include "trebsweep/sweep/scene_optima.hpp"

#include <cmath>

#include "support/archive_reader.hpp"
#include "support/catch.hpp"
#include "support/quiet_sweep.hpp"
#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/sweep.hpp"
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

}  // namespace

TEST_CASE("A scene's slice of a study is bitwise the sweep of that scene alone") {
  const TemporaryFile file("study"), alone("scene");
  const Job job = small_study(file);
  const Study study(job);
  for (const Index3& edge : {Index3{16, 16, 16}, Index3{4, 3, 5}}) {
    const auto summary = sweep(job, quiet(edge), MPI_COMM_WORLD);
    REQUIRE(summary);
    CHECK(summary->designs() == study.designs());
    for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
      Job single = job_at(job, scene);
      single.output.file = alone.path();
      const auto own = sweep(single, quiet(), MPI_COMM_WORLD);
      if (!root()) continue;
      REQUIRE(summary->optima.size() == study.scenes());
      const SceneOptimum& optimum = summary->optima[scene];
      CHECK(same_bits(optimum.speed, own->optimum->speed));
      CHECK(same_bits(optimum.r1, own->optimum->design.r1));
      CHECK(same_bits(optimum.r2, own->optimum->design.r2));
      CHECK(same_bits(optimum.release_time, own->optimum->release_time));
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
  const auto with_maps = sweep(job, quiet(), MPI_COMM_WORLD);
  job.output.file = without.path();
  job.output.maps = Maps::none;
  const auto summary = sweep(job, quiet(), MPI_COMM_WORLD);
  CHECK(summary->statuses == with_maps->statuses);
  if (!root()) return;
  CHECK_THROWS(read_map(without.path(), "speed"));
  for (const std::string_view name : scene_optimum_names) {
    const auto a = read_map(file.path(), std::string(name)),
               b = read_map(without.path(), std::string(name));
    REQUIRE(a.size() == 6);
    CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end(), same_bits));
  }
  for (std::uint64_t scene = 0; scene < 6; ++scene) {
    const SceneOptimum& optimum = summary->optima[scene];
    const Design<double> design{optimum.r1, optimum.r3, optimum.r2};
    SwingResult accurate{};
    const Job single = job_at(job, scene);
    integrate_accurately(single.scene, single.solver, {{&design, 1}, {&accurate, 1}});
    CHECK(optimum.error == std::abs(optimum.speed - accurate.speed));
    CHECK(optimum.error < 1e-4);
  }
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
    return RefinedOptimum{{{design.r1, design.r3, 7}, value, 3, 4}, 5};
  };
  const auto summary = sweep(job, options, MPI_COMM_WORLD);
  REQUIRE(summary->refined);
  CHECK(summary->refined->optimum.value == 101.5);
  CHECK(summary->refined->optimum.scene == 5);
  if (!root()) return;
  const auto stored = best_refined(job, read_contents(file.path()).optima);
  REQUIRE(stored);
  CHECK(stored->optimum.scene == 5);
  CHECK(read_map(file.path(), "best_value") ==
        std::vector<double>{51.2, 51.25, 51.5, 101.2, 101.25, 101.5});
  CHECK(read_map(file.path(), "best_r2") == std::vector<double>(6, 7));
  CHECK(read_map(file.path(), "best_error") == std::vector<double>(6, 5));
}

TEST_CASE("A scene without a release has no optimum, and the others have theirs") {
  const TemporaryFile file("study");
  Job job = small_study(file);
  job.outer_axes[0] = {"scene.pivot-friction", {0, 1e9}, "0, 1e9"};
  const auto summary = sweep(job, quiet(), MPI_COMM_WORLD);
  if (!root()) return;
  for (std::uint64_t scene = 0; scene < 6; ++scene)
    CHECK(summary->optima[scene].exists() == (scene < 3));
}

TEST_CASE("A study that is stopped again and again ends with the same archive as one in one go") {
  const TemporaryFile straight("straight"), stopped("stopped");
  const Index3 edge{4, 3, 5};
  const auto expected = sweep(small_study(straight), quiet(edge), MPI_COMM_WORLD);
  const Job job = small_study(stopped);
  SweepOptions options = quiet(edge);
  options.overwrite = false;
  std::optional<Summary> summary;
  int runs = 0;
  do {
    int calls_left = runs == 0 ? 8 : 12 + 2 * runs;
    options.stop = [&] { return calls_left-- <= 0; };
    summary = sweep(job, options, MPI_COMM_WORLD);
    REQUIRE(summary);
    ++runs;
  } while (!summary->complete && runs < 200);
  CHECK(runs > 5);
  CHECK(summary->statuses == expected->statuses);
  CHECK(summary->optimum->scene == expected->optimum->scene);
  if (!root()) return;
  for (const char* map : {"speed", "status", "projectile_mass", "fulcrum_height", "r1",
                          "best_speed", "best_r1", "best_error", "tile_done"}) {
    const auto a = read_map(straight.path(), map), b = read_map(stopped.path(), map);
    CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end(), same_bits));
  }
}
