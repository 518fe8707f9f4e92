#include "trebsweep/sweep/sweep.hpp"

#include <cmath>

#include "support/archive_reader.hpp"
#include "support/catch.hpp"
#include "support/quiet_sweep.hpp"
#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/config_file.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

Job coarse_job(const TemporaryFile& file) {
  Job job;
  job.lattice.increment = 0.1;
  job.solver.stepper = "dopri5";
  job.solver.release = Release::crossing;
  job.output.file = file.path();
  return job;
}

}  // namespace

TEST_CASE(
    "On any number of ranks and for any tiles, a cell is bitwise its design integrated alone") {
  const TemporaryFile file("sweep");
  const Job job = coarse_job(file);
  for (const Index3& edge : {Index3{16, 16, 16}, Index3{1, 1, 1}, Index3{2, 5, 3}}) {
    const Summary summary = summary_of(job, quiet(edge));
    if (root()) {
      const Lattice lattice(job.scene, job.lattice);
      const auto speed = read_map(file.path(), "speed"),
                 time = read_map(file.path(), "release_time");
      const auto status = read_map(file.path(), "status");
      const Index3 n = lattice.extent();
      double best = 0;
      std::size_t cell = 0;
      for (std::size_t a = 0; a < n[0]; ++a)
        for (std::size_t b = 0; b < n[1]; ++b)
          for (std::size_t c = 0; c < n[2]; ++c, ++cell) {
            if (!lattice.holds({a, b, c})) {
              REQUIRE(std::isnan(speed[cell]));
              REQUIRE(status[cell] == 0);
              continue;
            }
            const Design<double> design = lattice.design({a, b, c});
            SwingResult alone;
            integrate(job.scene, job.solver, {{&design, 1}, {&alone, 1}});
            REQUIRE(same_bits(speed[cell], alone.speed));
            REQUIRE(same_bits(time[cell], alone.release_time));
            REQUIRE(status[cell] == static_cast<double>(alone.status));
            best = std::max(best, speed[cell]);
          }
      CHECK(best_of(summary).speed == best);
      CHECK(summary.tally.designs() == lattice.designs());
    }
  }
}

TEST_CASE("The accurate job's speeds are within 1e-7 m/s of those at a tolerance of 1e-12",
          "[alone]") {
  Job job = parse_job(read_job_file(SOURCE_DIR "/jobs/accurate.cfg"), "accurate.cfg", {});
  job.lattice.increment = 0.05;
  const TemporaryFile file("accurate");
  job.output.file = file.path();
  summary_of(job);
  const std::vector<double> speed = root() ? read_map(file.path(), "speed") : std::vector<double>{};
  job.solver.stepper = "fehlberg78";
  job.solver.tolerance = 1e-12;
  const Summary summary = summary_of(job);
  CHECK(summary.tally.designs() ==
        summary.tally.statuses[static_cast<std::size_t>(Status::released)]);
  if (root()) {
    const auto truth = read_map(file.path(), "speed");
    std::uint64_t close = 0, different = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      close += std::abs(speed[i] - truth[i]) < 1e-7;  // false for NaN
      different += speed[i] != truth[i] && !std::isnan(truth[i]);
    }
    CHECK(close == summary.tally.designs());
    CHECK(different > 0);
  }
}

TEST_CASE("A sweep of one design gives the same optimum on any number of ranks") {
  const TemporaryFile file("single");
  Job job = coarse_job(file);
  job.lattice.r1 = AxisRange{0.75, 0.75, 1};
  job.lattice.r3 = AxisRange{3, 3, 1};
  job.lattice.r2 = AxisRange{4, 4, 1};
  job.scene.gravity = 9.81;
  const Summary summary = summary_of(job);
  CHECK(summary.tally.designs() == 1);
  CHECK(best_of(summary).speed == Approx(23.7371408230).margin(1e-6));
  CHECK(best_of(summary).design.r2 == 4);
}

TEST_CASE("Designs without a release have a status, but neither speed nor release time") {
  const TemporaryFile file("statuses");
  Job job = coarse_job(file);
  job.lattice.r1 = AxisRange{0.4, 0.6, 0.1};
  job.solver.max_time = 0.7;
  const Summary summary = summary_of(job);
  const auto count = [&](Status s) { return summary.tally.statuses[static_cast<std::size_t>(s)]; };
  CHECK(count(Status::unreachable_start) == summary.tally.designs() / 3);
  CHECK(count(Status::not_released) > summary.tally.designs() / 3);
  CHECK(count(Status::released) > 0);
  if (root()) {
    const auto speed = read_map(file.path(), "speed"), time = read_map(file.path(), "release_time");
    const auto status = read_map(file.path(), "status");
    for (std::size_t i = 0; i < status.size(); ++i) {
      const bool released = status[i] == static_cast<double>(Status::released);
      REQUIRE(std::isnan(speed[i]) == !released);
      REQUIRE(std::isnan(time[i]) == !released);
    }
  }
}

TEST_CASE("The fields that decide about the optimum are not stored unless they are requested") {
  const TemporaryFile file("deciding");
  Job job = coarse_job(file);
  job.optimum.objective = to_expression(Field::range);
  job.optimum.constraints = {{to_expression(Field::peak_axle_load), true, 2e5}};
  summary_of(job);
  if (root()) {
    CHECK_NOTHROW(read_map(file.path(), "speed"));
    CHECK_THROWS(read_map(file.path(), "range"));
    CHECK_THROWS(read_map(file.path(), "peak_axle_load"));
  }
}

TEST_CASE("Only the requested maps are stored") {
  const TemporaryFile file("fields");
  Job job = coarse_job(file);
  job.output.fields = {Field::speed};
  summary_of(job);
  if (root()) {
    CHECK_NOTHROW(read_map(file.path(), "speed"));
    CHECK_THROWS(read_map(file.path(), "release_time"));
    CHECK_THROWS(read_map(file.path(), "status"));
  }
}

TEST_CASE("An existing archive is kept: the same job is complete, another job is refused") {
  const TemporaryFile file("kept");
  Job job = coarse_job(file);
  SweepOptions options = quiet();
  const auto run = [&] { return sweep(Study(job), options, MPI_COMM_WORLD); };
  run();
  const auto before = std::filesystem::last_write_time(file.path());
  options.overwrite = false;
  CHECK_FALSE(run());
  job.scene.gravity = 9.81;
  CHECK_THROWS_WITH(run(), contains("archive of another job"));
  CHECK(std::filesystem::last_write_time(file.path()) == before);
  options.overwrite = true;
  CHECK(run());
}

TEST_CASE("The archive's contents are the summary, which is the same on all ranks") {
  const TemporaryFile file("summary");
  Job job = coarse_job(file);
  job.outer_axes = {{"scene.projectile-mass", {50, 100}, "50, 100"}};
  const Summary summary = summary_of(job);
  REQUIRE(summary.error);
  const MeasuredError error = mpi::from_root(*summary.error, MPI_COMM_WORLD);
  CHECK(same_bits(error.largest, summary.error->largest));
  for (const BestDesign& optimum : summary.optima)
    CHECK(to_numbers(optimum) == mpi::from_root(to_numbers(optimum), MPI_COMM_WORLD));
  CHECK(summary.tally.utilisation() > 0);
  CHECK(summary.tally.utilisation() <= 1);
  if (!root()) return;
  const Summary stored = read_contents(file.path()).summary;
  CHECK(stored.tally.statuses == summary.tally.statuses);
  CHECK(stored.tally.steps == summary.tally.steps);
  CHECK(stored.tally.utilisation() == summary.tally.utilisation());
  CHECK(stored.error->largest == summary.error->largest);
  CHECK(stored.complete);
  REQUIRE(stored.optima.size() == summary.optima.size());
  for (std::size_t scene = 0; scene < stored.optima.size(); ++scene)
    CHECK(to_numbers(stored.optima[scene]) == to_numbers(summary.optima[scene]));
}

TEST_CASE("A sweep stopped repeatedly produces bitwise the same maps and the same optimum") {
  const TemporaryFile straight("straight"), stopped("stopped");
  Job job = coarse_job(straight);
  const auto [compression, filter] =
      GENERATE(table<int, OptimumFilter>({{0, OptimumFilter::all}, {1, OptimumFilter::taut}}));
  job.output.compression = compression;
  job.output.fields = {Field::speed, Field::slack};
  job.output.optimum_filter = filter;
  job.lattice.r1 = AxisRange{0.4, 1.4, 0.1};
  constexpr Index3 edge{1, 3, 3};
  const Summary expected = summary_of(job, quiet(edge));
  CHECK(expected.complete);

  job.output.file = stopped.path();
  SweepOptions options = quiet();
  options.overwrite = false;
  Summary summary;
  std::uint64_t before = 0;
  int runs = 0;
  do {
    int calls_left = runs < 5 ? 7 : 30;  // in the end enough for the check of the error
    options.stop = [&] { return calls_left-- <= 0; };
    options.tile_edge = runs < 1 ? edge : Index3{7, 7, 7};  // ignored: the sweep has its own
    summary = summary_of(job, options);
    // Every run makes progress.
    CHECK((summary.tally.designs() > before || before == expected.tally.designs()));
    before = summary.tally.designs();
    ++runs;
  } while (!summary.complete && runs < 100);
  CHECK(runs > 3);
  CHECK(summary.tally.statuses == expected.tally.statuses);
  CHECK(summary.tally.steps == expected.tally.steps);
  const BestNumbers best = to_numbers(summary.optima[0]),
                    expected_best = to_numbers(expected.optima[0]);
  CHECK(std::equal(best.begin(), best.end(), expected_best.begin(), same_bits));
  if (root()) {
    for (const char* map : {"speed", "slack", "r1", "r3", "r2", "tile_block", "tile_designs"}) {
      const auto a = read_map(straight.path(), map), b = read_map(stopped.path(), map);
      REQUIRE(std::equal(a.begin(), a.end(), b.begin(), b.end(), same_bits));
    }
    CHECK_FALSE(std::filesystem::exists(partial_path(stopped.path())));
  }
}

TEST_CASE("Ranks with and without fused multiply-add are refused together, and no others") {
  const auto check = [](const char* first, const char* others) {
    check_arithmetic(mpi::rank(MPI_COMM_WORLD) == 0 ? first : others, MPI_COMM_WORLD);
  };
  const char *baseline = "baseline (2 lanes)", *avx2 = "AVX2 with FMA (4 lanes)";
  CHECK_NOTHROW(check(avx2, "AVX-512 (8 lanes)"));
  CHECK_NOTHROW(check(baseline, baseline));
  if (mpi::size(MPI_COMM_WORLD) == 1) return;
  CHECK_THROWS_WITH(check(avx2, baseline), contains("use nodes of one kind"));
  CHECK_THROWS_WITH(check(baseline, avx2), contains("use nodes of one kind"));
}
