#include "trebsweep/optimum/design_problem.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/optimum/local_search.hpp"

using namespace trebsweep;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const Design<double> typical{0.55, 0.6, 0.85};

const Job& limited_job() {
  static const Job job =
      job_with({{"optimum.objective", "range"},
                {"optimum.subject-to", "peak-axle-load <= 1.1e5, least-sling-tension >= 100"}});
  return job;
}

/// The range, and by how much the constraints of limited_job() are violated.
VectorXd exact_values(const Design<double>& design) {
  const auto value = [&](Field field) { return accurate_value(limited_job(), field, design); };
  VectorXd values(3);
  values << value(Field::range), value(Field::peak_axle_load) - 1.1e5,
      100 - value(Field::least_sling_tension);
  return values;
}

double optimum_of(const DesignProblem& problem) {
  std::uint64_t integrated = 0;
  const KktPoint found =
      search(nominal_program(problem, integrated), to_scaled(problem, to_parameters(typical)));
  REQUIRE(is_feasible(found.point));
  REQUIRE(found.converged);
  return found.point.objective * problem.scales[0];
}

/// Checks the multiplier of a limit with a central difference; `change` adds to the limit.
template <class Change>
void check_multiplier(const DesignProblem& problem, const std::string& text, double h,
                      Change change) {
  std::uint64_t integrated = 0;
  const KktPoint found =
      search(nominal_program(problem, integrated), to_scaled(problem, to_parameters(typical)));
  const std::vector<Limit> all = limits(problem);
  REQUIRE(found.multipliers.size() == static_cast<Index>(all.size()));
  const auto limit = std::ranges::find(all, text, &Limit::text);
  REQUIRE(limit != all.end());
  const double multiplier = found.multipliers(limit - all.begin()) * limit->factor;
  DesignProblem wider = problem, narrower = problem;
  change(wider, h);
  change(narrower, -h);
  INFO(text);
  CHECK(multiplier != 0);
  CHECK((optimum_of(wider) - optimum_of(narrower)) / (2 * h) == Approx(multiplier).epsilon(1e-3));
}

bool has_limit(const DesignProblem& problem) { return !problem.space.limits.empty(); }

}  // namespace

TEST_CASE("Variables are the lengths that are not fixed, of the order of one") {
  Job job;
  const DesignProblem free = design_problem(job, to_parameters(typical));
  CHECK(free.free == std::vector<Index>{0, 1, 2});
  job.lattice.r3 = AxisRange{0.6, 0.6, 1};
  const DesignProblem fixed = design_problem(job, to_parameters(typical));
  CHECK(fixed.free == std::vector<Index>{0, 2});
  for (const DesignProblem& problem : {free, fixed}) {
    const VectorXd x = to_scaled(problem, to_parameters(typical));
    CHECK(x.size() == static_cast<Index>(problem.free.size()));
    CHECK(x.minCoeff() > 0.3);
    CHECK(x.maxCoeff() < 3);
    const Parameters there_and_back = to_parameters(problem, x);
    CHECK((there_and_back - to_parameters(typical)).norm() < 1e-15);
  }
}

TEST_CASE("The sum of r2 and r3 is limited unless both are fixed or r2 is explicit") {
  Job job;
  CHECK(has_limit(design_problem(job, to_parameters(typical))));
  job.lattice.r3 = AxisRange{0.6, 0.6, 1};
  CHECK(has_limit(design_problem(job, to_parameters(typical))));
  job.lattice.r2 = AxisRange{0.5, 1, 0.1};
  CHECK_FALSE(has_limit(design_problem(job, to_parameters(typical))));
}

TEST_CASE("Values are the objective and the violations, in units of their scales") {
  const DesignProblem problem = design_problem(limited_job(), to_parameters(typical));
  CHECK(problem.scales[0] == Approx(accurate_value(limited_job(), Field::range, typical)));
  CHECK(problem.scales[1] == 1.1e5);
  CHECK(problem.scales[2] == 100);
  const std::vector<Design<double>> designs{typical, {0.7, 0.4, 1}, {0.3, 0.4, 1}};
  const MatrixXd values = values_at(problem, to_parameters(designs));
  for (Index i = 0; i < 2; ++i) {
    const VectorXd exact = exact_values(designs[static_cast<std::size_t>(i)]);
    for (Index row = 0; row < 3; ++row)
      CHECK(values(row, i) * problem.scales[static_cast<std::size_t>(row)] ==
            Approx(exact(row)).epsilon(1e-6));
  }
  CHECK(values.col(2).array().isNaN().all());  // not released
}

TEST_CASE("With output.optimum = taut the tension of the sling must not fall below zero") {
  const Job rigid = job_with({{"output.optimum", "taut"}, {"optimum.subject-to", "apex <= 30"}});
  CHECK(to_text(constraints_of(rigid).front()) == "apex <= 30");
  REQUIRE(constraints_of(rigid).size() == 2);
  CHECK(to_text(constraints_of(rigid).back()) == "least-sling-tension >= 0");
  CHECK(constraints_of(Job{}).empty());
}

TEST_CASE("With output.optimum = taut a search excludes elastic slings that go slack") {
  Job job = job_with({{"output.optimum", "taut"}});
  job.scene.sling_stiffness = 1e5;
  const std::vector<Design<double>> designs{typical, {.r1 = 0.53, .r3 = 1.13, .r2 = 0.25}};
  const DesignProblem problem = design_problem(job, to_parameters(typical));
  CHECK(problem.scales[1] == Approx(9.8e2).epsilon(0.1));
  const MatrixXd values = values_at(problem, to_parameters(designs));
  CHECK(accurate_value(job, Field::least_sling_tension, designs[1]) == 0);
  CHECK(values(1, 0) < -0.1);
  CHECK(values(1, 1) > feasibility_tolerance);
}

TEST_CASE("Objectives and constraints are those of the deviating designs, in the header's order") {
  const DesignProblem problem = design_problem(limited_job(), to_parameters(typical));
  const std::vector<Deviation> deviations{{Eigen::Vector3d(0.01, 0, 0), 0.25, true},
                                          {Eigen::Vector3d(0, -0.02, 0), 0.75, false},
                                          {Eigen::Vector3d(0, 0, 0.03), 0, true}};
  const VectorXd first = exact_values({typical.r1 + 0.01, typical.r3, typical.r2});
  const VectorXd second = exact_values({typical.r1, typical.r3 - 0.02, typical.r2});
  const VectorXd third = exact_values({typical.r1, typical.r3, typical.r2 + 0.03});
  const auto& s = problem.scales;
  VectorXd constraints(5);
  constraints << first(1) / s[1], first(2) / s[2], third(1) / s[1], third(2) / s[2],
      (typical.r2 + typical.r3) / 1.5 - 1;
  for (const Aggregate aggregate : {Aggregate::worst, Aggregate::mean}) {
    VectorXd objectives(aggregate == Aggregate::mean ? 1 : 2);
    if (aggregate == Aggregate::mean)
      objectives << (0.25 * first(0) + 0.75 * second(0)) / s[0];
    else
      objectives << first(0) / s[0], second(0) / s[0];
    std::uint64_t integrated = 0;
    const NonlinearProgram program = program_of(problem, deviations, aggregate, integrated);
    REQUIRE(program.objectives == objectives.size());
    REQUIRE(program.constraints == constraints.size());
    const VectorXd x = to_scaled(problem, to_parameters(typical));
    const VectorXd values = program.functions(x).col(0);
    CHECK((values.head(objectives.size()) - objectives).cwiseAbs().maxCoeff() < 1e-6);
    CHECK((values.tail(5) - constraints).cwiseAbs().maxCoeff() < 1e-6);
    CHECK(integrated == 3);
    CHECK((program.lower.array() < x.array()).all());
    CHECK((program.upper.array() > x.array()).all());
  }
}

TEST_CASE("The limits are the constraints, then r2 + r3 <= h0, lower and upper bounds") {
  Job job = limited_job();
  job.lattice.r1 = AxisRange{0.52, 0.7, 0.1};
  std::vector<std::string> texts;
  for (const Limit& limit : limits(design_problem(job, to_parameters(typical))))
    texts.push_back(limit.text);
  CHECK(texts == std::vector<std::string>{"peak-axle-load <= 110000", "least-sling-tension >= 100",
                                          "r2 + r3 <= 1.5", "r1 >= 0.52", "r3 >= 0.3", "r2 >= 0",
                                          "r1 <= 0.7", "r3 <= 1.5", "r2 <= 1.5"});
}

TEST_CASE("A multiplier is the change of the optimum when its limit changes") {
  const auto sum = [](DesignProblem& p, double h) {
    p.space.limits[0].excess = [h](const Scene& scene, const Design<double>& design) {
      return design.r2 + design.r3 - scene.fulcrum_height - h;
    };
  };
  const auto field = [](DesignProblem& p, double h) { p.constraints[0].limit += h; };
  check_multiplier(design_problem(Job{}, to_parameters(typical)), "r2 + r3 <= 1.5", 1e-4, sum);

  const DesignProblem bounded =
      design_problem(job_with({{"lattice.r1", "0.55:0.8:0.01"}, {"lattice.r2", "0.5:0.8:0.01"}}),
                     to_parameters({0.6, 0.6, 0.7}));
  check_multiplier(bounded, "r1 >= 0.55", 1e-4,
                   [](DesignProblem& p, double h) { p.space.lower(0) += h; });
  check_multiplier(bounded, "r2 <= 0.8", 1e-4,
                   [](DesignProblem& p, double h) { p.space.upper(2) += h; });

  const DesignProblem axle = design_problem(
      job_with({{"optimum.subject-to", "peak-axle-load <= 1.6e5"}}), to_parameters(typical));
  check_multiplier(axle, "peak-axle-load <= 160000", 16, field);
  check_multiplier(axle, "r2 + r3 <= 1.5", 1e-4, sum);
  const DesignProblem energy = design_problem(
      job_with({{"optimum.objective", "range"}, {"optimum.subject-to", "efficiency <= 0.25"}}),
      to_parameters(typical));
  check_multiplier(energy, "efficiency <= 0.25", 2.5e-5, field);
  const DesignProblem high = design_problem(
      job_with({{"optimum.objective", "speed"}, {"optimum.subject-to", "apex >= 5"}}),
      to_parameters(typical));
  check_multiplier(high, "apex >= 5", 5e-4, field);
  const DesignProblem beam =
      design_problem(job_with({{"optimum.subject-to", "r1 + r2 <= 1.35"}}), to_parameters(typical));
  check_multiplier(beam, "r1 + r2 <= 1.35", 1e-4, field);
  const DesignProblem ratio = design_problem(
      job_with({{"optimum.subject-to", "peak-axle-load / counterweight-mass <= 32"}}),
      to_parameters(typical));
  check_multiplier(ratio, "peak-axle-load / counterweight-mass <= 32", 3e-3, field);
}

TEST_CASE("A limit of an expression is that of its field, in another unit") {
  std::uint64_t count = 0;
  const auto optimum = [&](const std::string& constraint) {
    const DesignProblem problem =
        design_problem(job_with({{"optimum.subject-to", constraint}}), to_parameters(typical));
    return search(nominal_program(problem, count), to_scaled(problem, to_parameters(typical)))
        .point.x;
  };
  const auto of_field = optimum("peak-axle-load <= 1.6e5");
  for (const std::string same :
       {"peak-axle-load / counterweight-mass <= 32", "-peak-axle-load >= -1.6e5",
        "abs(peak-axle-load - 1e5) / 1000 <= 60"})
    CHECK((optimum(same) - of_field).norm() < 1e-8);
}
