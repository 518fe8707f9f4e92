#include "trebsweep/sweep/measured_error.hpp"

#include <cstring>

#include "support/catch.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/reference.hpp"

using namespace trebsweep;

namespace {

bool never() { return false; }

/// The results of a job's whole lattice.
struct Results {
  std::vector<Design<double>> designs;
  std::vector<SwingResult> swings;
};

Results integrate_all(const Job& job) {
  Results all;
  all.designs = all_designs(Lattice(job.scene, job.lattice));
  all.swings.resize(all.designs.size());
  integrate(job.scene, job.solver, {all.designs, all.swings});
  return all;
}

/// What they amount to. The sweep took long enough for a check of a minute.
Totals totals_of(const Job& job, const Results& all) {
  const Study study(job);
  Totals totals(1);
  for (std::size_t n = 0; n < all.designs.size(); ++n) {
    const Index3 index = study.lattice(0).index_of(all.designs[n]);
    totals.tally.add(all.swings[n], study.cell(0, index), all.designs[n], all.swings[n].speed);
  }
  totals.best[0] = totals.tally.best;
  totals.tally.sweep_seconds = 6000;
  return totals;
}

/// The checks of a job with one scene, and the error that they show.
struct Measured {
  std::vector<Check> checks;
  std::optional<MeasuredError> error;
};

Measured measure(const Job& job, const Results& all, MPI_Comm comm = MPI_COMM_WORLD) {
  const auto samples = check_scenes(Study(job), totals_of(job, all), never, comm);
  REQUIRE(samples);
  REQUIRE(samples->size() == 1);
  return {samples->front().checks, measured_error(*samples, 0)};
}

/// A job on a lattice of some ten thousand designs.
Job medium_job() {
  Job job;
  job.lattice.increment = 0.04;
  return job;
}

}  // namespace

TEST_CASE("No error on the whole lattice is larger than three times the measured largest one",
          "[alone]") {
  std::vector<Job> jobs(7, medium_job());
  jobs[1].solver = paper_solver();
  jobs[2].solver.stepper = "dopri5";
  jobs[3].scene.pivot_friction = 510;
  jobs[4].scene.sling_stiffness = 3e5;
  jobs[4].scene.sling_damping = 500;
  jobs[4].scene.sling_mass = 1;
  jobs[5].solver.stepper = "fehlberg78";
  jobs[6] = jobs[4];
  jobs[6].lattice.increment = 0.02;  // the largest error is that of a single design
  for (const Job& job : jobs) {
    const Results all = integrate_all(job);
    const auto error = measure(job, all).error;
    REQUIRE(error);
    std::vector<SwingResult> truth(all.designs.size());
    integrate_accurately(job.scene, checking_solver(job.scene, job.solver), {all.designs, truth});
    std::vector<double> errors;
    for (std::size_t n = 0; n < truth.size(); ++n)
      errors.push_back(std::abs(all.swings[n].speed - truth[n].speed));
    std::sort(errors.begin(), errors.end());
    CHECK(errors.back() < 3 * error->largest);
    CHECK(error->largest < 1.001 * errors.back());
    CHECK(error->median == Approx(errors[errors.size() / 2]).epsilon(0.2));
  }
}

TEST_CASE("The measured error is bitwise the same on any number of ranks") {
  const Job job = medium_job();
  const Results all = integrate_all(job);
  const auto together = measure(job, all), alone = measure(job, all, MPI_COMM_SELF);
  REQUIRE(together.error);
  CHECK(std::memcmp(&*together.error, &*alone.error, sizeof(MeasuredError)) == 0);
  REQUIRE(together.checks.size() == alone.checks.size());
  for (std::size_t i = 0; i < alone.checks.size(); ++i)
    REQUIRE(together.checks[i].accurate.speed == alone.checks[i].accurate.speed);
}

TEST_CASE("The error at the optimum is that of extended precision", "[alone]") {
  for (const double tolerance : {1e-6, 1e-9, 1e-13}) {
    Job job = medium_job();
    job.solver.tolerance = tolerance;
    const Results all = integrate_all(job);
    const BestDesign best = totals_of(job, all).best[0];
    const double truth = reference(job.scene, best.design, job.solver).speed;
    const double error = std::abs(best.speed - truth);
    CHECK(measure(job, all).error->at_optimum == Approx(error).epsilon(0.01).margin(4e-15));
  }
}

TEST_CASE("The checks include a status that a single design has", "[alone]") {
  Job job = medium_job();
  Results all = integrate_all(job);
  std::vector<double> times;
  for (const SwingResult& swing : all.swings) times.push_back(swing.release_time);
  std::sort(times.begin(), times.end());
  job.solver.max_time = (times.back() + times[times.size() - 2]) / 2;
  all = integrate_all(job);
  REQUIRE(totals_of(job, all).tally.statuses[static_cast<std::size_t>(Status::not_released)] == 1);
  const auto checks = measure(job, all).checks;
  CHECK(std::count_if(checks.begin(), checks.end(),
                      [](const Check& c) { return c.result.status == Status::not_released; }) == 1);
}

TEST_CASE("The objective is that of designs that satisfy the constraints, next to the optimum",
          "[alone]") {
  Job job = medium_job();
  job.optimum.objective = to_expression(Field::range);
  job.optimum.constraints = {{to_expression(Field::peak_axle_load), true, 1.5e5}};
  const auto checks = measure(job, integrate_all(job)).checks;
  const std::array fields{Field::range, Field::peak_axle_load};
  int satisfied = 0, violated = 0;
  for (const Check& c : checks) {
    if (std::isnan(c.slack)) {
      CHECK(std::isnan(c.objective));
      continue;
    }
    std::array<double, 2> values{};
    SwingResult result{};
    integrate(job.scene, job.solver, {{&c.design, 1}, {&result, 1}, fields, values});
    const bool satisfies = values[1] <= 1.5e5;
    ++(satisfies ? satisfied : violated);
    CHECK((satisfies ? c.objective == values[0] : std::isnan(c.objective)));
  }
  CHECK(satisfied + violated >= 8);
  CHECK(violated > 0);
}

TEST_CASE("With an objective of the flight, releases below the ground count as accurate releases",
          "[alone]") {
  Job job;
  job.scene.fulcrum_height = 0.1;
  job.scene.release_height = 0.5;
  job.lattice.r1 = AxisRange{0.51, 0.51, 1};
  job.lattice.r3 = AxisRange{2.5, 3, 0.0001};
  job.lattice.r2 = AxisRange{0.4, 0.4, 1};
  job.optimum.objective = to_expression(Field::range);
  const auto checks = measure(job, integrate_all(job)).checks;
  int without_range = 0;
  for (const Check& c : checks) {
    CHECK(c.result.status == c.accurate.status);
    without_range += !std::isnan(c.slack) && std::isnan(c.objective);
  }
  CHECK(without_range > 0);
}

TEST_CASE("Every design of a lattice without a release is checked, and no error is measured",
          "[alone]") {
  Job job;
  job.lattice.increment = 0.2;
  job.scene.pivot_friction = 1e9;
  const auto [checks, error] = measure(job, integrate_all(job));
  CHECK(checks.size() == Lattice(job.scene, job.lattice).designs());
  CHECK_FALSE(error);
}

TEST_CASE("Designs that cannot be integrated accurately are left out", "[alone]") {
  Job job;  // far too stiff for an explicit stepper
  job.scene.sling_stiffness = 1e12;
  job.scene.sling_damping = 1e12;
  job.solver.stepper = "rosenbrock4";
  job.solver.tolerance = 1e-4;
  job.lattice.r1 = AxisRange{0.51, 0.52, 0.01};
  job.lattice.r3 = job.lattice.r2 = AxisRange{0.6, 0.6, 1};
  const Results all = integrate_all(job);
  REQUIRE(all.swings[0].status == Status::released);
  const auto [checks, error] = measure(job, all);
  CHECK(checks.empty());
  CHECK_FALSE(error);
}

TEST_CASE("The scenes that are checked include those of the optimum and of rare statuses") {
  Job job;
  job.lattice.r1 = job.lattice.r3 = AxisRange{0.6, 0.6, 1};
  job.lattice.r2 = AxisRange{0.8, 0.8, 1};
  job.outer_axes = {{"scene.projectile-mass", {}, "1:100:1"}};
  for (int mass = 1; mass <= 100; ++mass) job.outer_axes[0].values.push_back(mass);
  const Study study(job);
  Totals totals(100);
  totals.best[41].value = totals.best[41].speed = 1;
  totals.best[41].design = {0.6, 0.6, 0.8};
  totals.tally.first_cells[0] = study.cell(0, {0, 0, 0});
  totals.tally.first_cells[3] = study.cell(77, {0, 0, 0});
  const auto scenes = [&] {
    std::vector<std::uint64_t> numbers;
    const auto samples = check_scenes(study, totals, never, MPI_COMM_WORLD).value();
    for (const ErrorSample& sample : samples) {
      CHECK(sample.checks.size() == 1);
      CHECK(std::isnan(sample.at_best) == (sample.scene != 41));
      numbers.push_back(sample.scene);
    }
    return numbers;
  };
  CHECK(scenes() == std::vector<std::uint64_t>{0, 14, 28, 41, 42, 56, 70, 77, 84, 99});
  totals.optima[60].value = 2;  // a refined one
  CHECK(scenes() == std::vector<std::uint64_t>{0, 14, 28, 41, 42, 56, 60, 70, 77, 84, 99});
}

TEST_CASE("The error of a study is pooled over the scenes that were checked", "[alone]") {
  const auto check_with = [](double error, bool spread) {
    Check check{};
    check.result.speed = 1 + error;
    check.accurate.speed = 1;
    check.spread = spread;
    return check;
  };
  const std::array<ErrorSample, 2> samples{
      ErrorSample{0, {check_with(8, false), check_with(0.25, true), check_with(0.5, true)}, 0.125},
      ErrorSample{3, {check_with(2, true), check_with(4, false)}, 16}};
  const auto error = measured_error(samples, 3);
  REQUIRE(error);
  CHECK(error->median == 0.5);
  CHECK(error->largest == 16);
  CHECK(error->at_optimum == 16);
  CHECK(error->designs == 5);
}

TEST_CASE("No error is returned once any rank is stopped") {
  const Job job = medium_job();
  const Totals totals = totals_of(job, integrate_all(job));
  const auto stopped = [] { return mpi::rank(MPI_COMM_WORLD) == 0; };
  CHECK_FALSE(check_scenes(Study(job), totals, stopped, MPI_COMM_WORLD));
}
