#include "trebsweep/optimum/design_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "trebsweep/optimum/field_values.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The tension of an elastic sling that counts as taut, relative to the projectile's weight. A
/// slack one has none; searches take a limit of zero for satisfied.
constexpr double smallest_tension = 1e-6;

double weight(const Scene& scene) { return scene.projectile_mass * scene.gravity; }

/// An order of magnitude: |value|, or 1 if that is 0 or NaN.
double magnitude(double value) { return std::abs(value) > 0 ? std::abs(value) : 1; }

}  // namespace

double scale_of(const Constraint& constraint, const Scene& scene, double value) {
  const std::string& unit = constraint.expression.unit;
  const double size = unit == "m"   ? scene.fulcrum_height
                      : unit == "N" ? std::max(std::abs(value), weight(scene))
                                    : magnitude(value);
  constexpr double negligible = 2 * smallest_tension;
  const double limit = std::abs(constraint.limit);
  return limit > negligible * size ? limit : size;
}

bool has_sum(const DesignProblem& problem) {
  return problem.space.longest_sum &&
         std::ranges::any_of(problem.variables, [](std::size_t d) { return d > 0; });
}

std::vector<Constraint> constraints_of(const Job& job) {
  std::vector<Constraint> constraints = job.optimum.constraints;
  if (job.output.optimum_filter == OptimumFilter::taut) {
    // The tension of an elastic sling is never negative.
    const bool elastic = job.scene.sling_stiffness > 0;
    constraints.push_back({.expression = to_expression(Field::least_sling_tension),
                           .is_upper = false,
                           .limit = elastic ? smallest_tension * weight(job.scene) : 0});
  }
  return constraints;
}

std::vector<Constraint> build_constraints(const Scene& scene, const Solver& solver) {
  std::vector<Constraint> constraints;
  const auto add = [&](Field field, bool is_upper, double limit) {
    constraints.push_back(
        {.expression = to_expression(field), .is_upper = is_upper, .limit = limit});
  };
  add(Field::tip_clearance, false, 0);
  add(Field::counterweight_clearance, false, 0);
  add(Field::projectile_clearance, false, 0);
  if (scene.sling_stiffness == 0) add(Field::least_sling_tension, false, 0);
  if (located(solver.release) == Release::crossing) {  // the other rules are those of a pin
    add(Field::pin_angle, false, -std::numbers::pi);
    add(Field::pin_angle, true, std::numbers::pi);
  }
  return constraints;
}

Job searched_job(const Job& job) {
  Job searched = job;
  if (!job.optimum.buildable) return searched;
  const auto implies = [](const Constraint& a, const Constraint& b) {
    return a.expression.text == b.expression.text && a.is_upper == b.is_upper &&
           violation(b, a.limit) <= 0;
  };
  for (const Constraint& condition : build_constraints(job.scene, job.solver)) {
    const auto given = constraints_of(job);
    if (std::ranges::none_of(given, [&](const Constraint& c) { return implies(c, condition); }))
      searched.optimum.constraints.push_back(condition);
  }
  return searched;
}

DesignProblem design_problem(const Job& job, const Design<double>& typical) {
  DesignProblem problem{.scene = job.scene,
                        .solver = job.solver,
                        .space = design_space(job.scene, job.lattice),
                        .fields = {job.optimum.objective},
                        .constraints = constraints_of(job),
                        .scales = {},
                        .variables = {}};
  const std::vector<Field> constrained = fields_of(problem.constraints);
  problem.fields.insert(problem.fields.end(), constrained.begin(), constrained.end());
  const MatrixXd values = quantities(problem, job.scene, job.solver, {&typical, 1});
  problem.scales.push_back(magnitude(values(0)));
  for (std::size_t i = 0; i < problem.constraints.size(); ++i)
    problem.scales.push_back(
        scale_of(problem.constraints[i], job.scene, values(static_cast<Index>(i) + 1)));
  for (std::size_t d = 0; d < 3; ++d)
    if (problem.space.lower[d] < problem.space.upper[d]) problem.variables.push_back(d);
  return problem;
}

double length_scale(const DesignProblem& problem, std::size_t length) {
  return (problem.space.lower[length] + problem.space.upper[length]) / 2;
}

VectorXd to_variables(const DesignProblem& problem, const Design<double>& design) {
  VectorXd x(static_cast<Index>(problem.variables.size()));
  for (Index i = 0; i < x.size(); ++i) {
    const std::size_t d = problem.variables[static_cast<std::size_t>(i)];
    x(i) = lengths(design)[d] / length_scale(problem, d);
  }
  return x;
}

Design<double> to_design(const DesignProblem& problem, const VectorXd& variables) {
  std::array<double, 3> r = problem.space.lower;
  for (Index i = 0; i < variables.size(); ++i) {
    const std::size_t d = problem.variables[static_cast<std::size_t>(i)];
    r[d] = variables(i) * length_scale(problem, d);
  }
  return to_design(r);
}

MatrixXd quantities(const DesignProblem& problem, const Scene& scene, const Solver& solver,
                    std::span<const Design<double>> designs) {
  const MatrixXd fields = field_values(scene, solver, Accuracy::high, designs, problem.fields);
  const std::size_t count = problem.fields.size();
  MatrixXd values(1 + problem.constraints.size(), designs.size());
  for (std::size_t n = 0; n < designs.size(); ++n) {
    const Operands operands{scene, designs[n], problem.fields, {fields.data() + n * count, count}};
    const auto column = static_cast<Index>(n);
    values(0, column) = fields(0, column);
    for (std::size_t i = 0; i < problem.constraints.size(); ++i)
      values(static_cast<Index>(i) + 1, column) = problem.constraints[i].expression.value(operands);
  }
  return values;
}

MatrixXd values_at(const DesignProblem& problem, std::span<const Design<double>> designs) {
  MatrixXd values = quantities(problem, problem.scene, problem.solver, designs);
  values.row(0) /= problem.scales[0];
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const Constraint& constraint = problem.constraints[i];
    auto row = values.row(static_cast<Index>(i) + 1);
    row = row.unaryExpr([&](double v) { return violation(constraint, v) / problem.scales[i + 1]; });
  }
  return values;
}

NonlinearProgram program_of(const DesignProblem& problem, const std::vector<Deviation>& deviations,
                            Aggregate aggregate, std::uint64_t& integrated) {
  const auto objectives =
      aggregate == Aggregate::mean
          ? 1
          : std::ranges::count_if(deviations, [](const Deviation& d) { return d.weight > 0; });
  const auto constrained = std::ranges::count_if(deviations, &Deviation::constrained);
  const auto fields = static_cast<Index>(problem.constraints.size());
  const Index constraints = fields * constrained + (has_sum(problem) ? 1 : 0);
  const auto functions = [=, &integrated](const MatrixXd& points) {
    std::vector<Design<double>> designs;
    for (Index p = 0; p < points.cols(); ++p) {
      const Design<double> design = to_design(problem, points.col(p));
      for (const Deviation& d : deviations) designs.push_back(moved(design, d.lengths));
    }
    integrated += designs.size();
    const MatrixXd values = values_at(problem, designs);
    MatrixXd result = MatrixXd::Zero(objectives + constraints, points.cols());
    for (Index p = 0, column = 0; p < points.cols(); ++p) {
      Index objective = 0, row = objectives;
      for (const Deviation& d : deviations) {
        if (aggregate == Aggregate::mean)
          result(0, p) += d.weight * values(0, column);  // NaN also with a weight of 0
        else if (d.weight > 0)
          result(objective++, p) = values(0, column);
        if (d.constrained) {
          result.col(p).segment(row, fields) = values.col(column).tail(fields);
          row += fields;
        }
        ++column;
      }
      if (has_sum(problem)) {
        const Design<double> design = to_design(problem, points.col(p));
        result(row, p) = (design.r2 + design.r3) / *problem.space.longest_sum - 1;
      }
    }
    return result;
  };
  return {functions,
          objectives,
          constraints,
          to_variables(problem, to_design(problem.space.lower)),
          to_variables(problem, to_design(problem.space.upper)),
          static_cast<Index>(deviations.size())};
}

NonlinearProgram nominal_program(const DesignProblem& problem, std::uint64_t& integrated) {
  return program_of(problem, {{{}, 1, true}}, Aggregate::worst, integrated);
}

std::vector<Limit> limits(const DesignProblem& problem) {
  std::vector<Limit> all;
  const double objective = problem.scales[0];
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const Constraint& c = problem.constraints[i];
    all.push_back(
        {to_text(c), c.expression.unit, (c.is_upper ? 1 : -1) * objective / problem.scales[i + 1]});
  }
  if (has_sum(problem))
    all.push_back({fmt::format("r2 + r3 <= {:.9g}", *problem.space.longest_sum), "m",
                   objective / *problem.space.longest_sum});
  for (const bool upper : {false, true})
    for (const std::size_t d : problem.variables)
      all.push_back({fmt::format("{} {} {:.9g}", length_names[d], upper ? "<=" : ">=",
                                 (upper ? problem.space.upper : problem.space.lower)[d]),
                     "m", (upper ? 1 : -1) * objective / length_scale(problem, d)});
  return all;
}

}  // namespace trebsweep
