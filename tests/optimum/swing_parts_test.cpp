#include "trebsweep/optimum/swing_parts.hpp"

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/optimum/sensitivity.hpp"

using namespace trebsweep;
using Eigen::Index;

namespace {

/// A machine whose axle load has two peaks, which are equal at its optimum.
const std::string machine = R"([scene]
fulcrum-height = 2.3
counterweight-mass = 1157
projectile-mass = 27.8
beam-density = 600
beam-side = 0.136
beam-inertia = prism
start-angle = 0.5
[optimum]
variables = sling-angle -0.5:0.5
)";

Job least_load() {
  return job_from(machine + "minimize = peak-axle-load\nsubject-to = range >= 8.3");
}

Job farthest() {
  return job_from(machine + "objective = range\nsubject-to = peak-axle-load <= 12300");
}

bool is_about_range(const Job& job) { return job.optimum.objective.text == "range"; }

/// Parameters near both optima.
Parameters near_optimum() { return Eigen::Vector4d(0.12, 0.58, 1.71, -0.38); }

ProblemOptimum optimum_of(const Job& job) {
  std::uint64_t integrated = 0;
  const ProblemOptimum found =
      search(design_problem(job, near_optimum()), near_optimum(), Effort::thorough, integrated);
  REQUIRE(found.converged);
  return found;
}

double value_of(const Job& job) {
  const DesignProblem problem = design_problem(job, near_optimum());
  return optimum_of(job).point.objective * problem.scales[0];
}

double central_difference(Job job, const std::function<void(Job&, double)>& change, double h) {
  Job less = job;
  change(job, h);
  change(less, -h);
  return (value_of(job) - value_of(less)) / (2 * h);
}

}  // namespace

TEST_CASE("The extremes of a swing are those of its parts, which differ only in extremes") {
  for (const Job& job : {least_load(), farthest()}) {
    const DesignProblem problem = design_problem(job, near_optimum());
    std::uint64_t integrated = 0;
    const auto parts = split(problem, near_optimum(), integrated);
    REQUIRE(parts.size() > 1);
    const Eigen::VectorXd whole = values_at(problem, near_optimum());
    Eigen::MatrixXd values(whole.size(), std::ssize(parts));
    for (Index i = 0; const DesignProblem& part : parts)
      values.col(i++) = values_at(part, near_optimum());
    CHECK(values.row(0).minCoeff() == whole(0));
    for (Index row = 1; row < whole.size(); ++row) CHECK(values.row(row).maxCoeff() == whole(row));
    const Index load = is_about_range(job) ? 1 : 0, range = 1 - load;
    CHECK(values.row(load).minCoeff() < values.row(load).maxCoeff());
    CHECK(values.row(range).minCoeff() == values.row(range).maxCoeff());
  }
}

TEST_CASE("Every extreme of a hinged machine with a trough is that of three windows of its swing") {
  const Job job = job_from(R"([scene]
counterweight-mass = 60
counterweight-hanger = 0.26
projectile-mass = 0.5
projectile-diameter = 0.09
fulcrum-height = 1.1
start-angle = 0.6
trough = yes
beam-density = 450
beam-width = 0.045
beam-depth = 0.095
beam-inertia = prism
[solver]
release = farthest
)");
  const Parameters parameters = Eigen::Vector3d(0.66, 0.93, 0.83);
  const std::vector<Field> largest{Field::peak_axle_load, Field::peak_sling_tension,
                                   Field::peak_hanger_tension, Field::peak_beam_stress};
  const std::vector<Field> smallest{Field::least_sling_tension,     Field::least_hanger_tension,
                                    Field::tip_clearance,           Field::projectile_clearance,
                                    Field::counterweight_clearance, Field::ground_clearance};
  const auto values_in = [&](const TimeWindow& window, const std::vector<Field>& fields) {
    MachineFamily machine = family_of(job);
    machine.solver.recorded = window;
    return field_values(machine, Accuracy::high, parameters, fields);
  };
  const double end = std::numeric_limits<double>::infinity();
  const std::array<TimeWindow, 3> windows{{{0, 0.2}, {0.2, 0.4}, {0.4, end}}};
  Eigen::MatrixXd of_largest(largest.size(), 3), of_smallest(smallest.size(), 3);
  for (Index i = 0; const TimeWindow& window : windows) {
    of_largest.col(i) = values_in(window, largest);
    of_smallest.col(i++) = values_in(window, smallest);
  }
  const Eigen::VectorXd peaks = values_in({0, end}, largest), least = values_in({0, end}, smallest);
  CHECK(peaks.allFinite());
  CHECK(least.allFinite());
  CHECK(of_largest.rowwise().maxCoeff() == peaks);
  CHECK(of_smallest.rowwise().minCoeff() == least);
  CHECK(of_largest.rowwise().minCoeff() != peaks);
}

TEST_CASE("A swing whose load has one peak is not divided") {
  const Job job = job_with({{"optimum.objective", "-peak-axle-load"}});
  const Parameters parameters = Eigen::Vector3d(0.51, 0.58, 0.92);
  std::uint64_t integrated = 0;
  CHECK(split(design_problem(job, parameters), parameters, integrated).size() == 1);
  CHECK(split(design_problem(Job{}, parameters), parameters, integrated).size() == 1);
}

TEST_CASE("A swing is not divided where larger loads are better, or where extremes are added") {
  for (const std::string objective : {"peak-axle-load", "-peak-axle-load - peak-sling-tension"}) {
    const Job job = job_from(machine + "objective = " + objective);
    std::uint64_t integrated = 0;
    CHECK(split(design_problem(job, near_optimum()), near_optimum(), integrated).size() == 1);
  }
}

TEST_CASE("Where only a constraint has a kink, the objective keeps its derivatives") {
  const Job job = job_from(
      machine +
      "objective = range - 0.0001*peak-sling-tension\nsubject-to = peak-axle-load <= 12300");
  const ProblemOptimum optimum = optimum_of(job);
  REQUIRE(optimum.parts.size() > 1);
  const Parameters parameters = to_parameters(design_problem(job, near_optimum()), optimum.point.x);
  const Job found = with_variables(job, parameters.tail(1));
  const auto value = [&](double by) {
    Job other = found;
    other.scene.projectile_mass += by;
    return quantities(design_problem(job, near_optimum()), family_of(other), parameters)(0, 0);
  };
  CHECK(sensitivity(found, "scene.projectile-mass", parameters, optimum.parts).at_design ==
        Approx((value(1e-3) - value(-1e-3)) / 2e-3).epsilon(1e-5));
}

TEST_CASE("At an optimum with equal peaks, parts share the objective or a constraint") {
  const ProblemOptimum least = optimum_of(least_load());
  double weights = 0;
  for (const PartOptimum& part : least.parts) weights += part.weight;
  CHECK(weights == Approx(1).epsilon(1e-9));
  CHECK(std::ranges::count_if(least.parts, [](const auto& p) { return p.weight > 0.01; }) == 2);
  const ProblemOptimum range = optimum_of(farthest());
  CHECK(range.parts.front().weight == Approx(1).epsilon(1e-9));
  CHECK(std::ranges::count_if(range.parts, [](const auto& p) { return p.derivatives(0) > 0; }) ==
        2);
}

TEST_CASE("Derivatives at an optimum with equal peaks are those of optima of changed jobs",
          "[slow]") {
  for (const Job& job : {least_load(), farthest()}) {
    const ProblemOptimum optimum = optimum_of(job);
    double of_limit = 0;
    for (const PartOptimum& part : optimum.parts) of_limit += part.derivatives(0);
    const double limit = job.optimum.constraints.front().limit;
    CHECK(of_limit ==
          Approx(central_difference(
                     job, [](Job& j, double h) { j.optimum.constraints.front().limit += h; },
                     1e-4 * limit))
              .epsilon(1e-4));
    const Parameters parameters =
        to_parameters(design_problem(job, near_optimum()), optimum.point.x);
    const Job found = with_variables(job, parameters.tail(1));
    const Sensitivity mass = sensitivity(found, "scene.projectile-mass", parameters, optimum.parts);
    CHECK(mass.of_optimum ==
          Approx(central_difference(
                     job, [](Job& j, double h) { j.scene.projectile_mass += h; }, 1e-3))
              .epsilon(1e-4));
    CHECK(std::isnan(mass.at_design) != is_about_range(job));
  }
}
