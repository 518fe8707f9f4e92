#include "trebsweep/optimum/design_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// By how much parameters are beyond the limits of the space, scaled; a row per limit.
MatrixXd space_excesses(const DesignProblem& problem, const MatrixXd& parameters) {
  const auto& limits = problem.space.limits;
  MatrixXd excesses(limits.size(), parameters.cols());
  if (limits.empty()) return excesses;
  const MatrixXd no_values(0, parameters.cols());
  for_each_design(
      problem.machine, parameters, {}, no_values, [&](Index column, const Operands& operands) {
        for (Index row = 0; const SpaceLimit& limit : limits)
          excesses(row++, column) =
              limit.excess(operands.scene, operands.design) / problem.machine.scene.fulcrum_height;
      });
  return excesses;
}

}  // namespace

double scale_of(const Constraint& constraint, const Scene& scene, double value) {
  const std::string& unit = constraint.expression.unit;
  const double size = unit == "m"   ? scene.fulcrum_height
                      : unit == "N" ? std::max(weight(scene), std::abs(value))
                                    : magnitude(value);
  constexpr double negligible = 2 * smallest_tension;
  const double limit = std::abs(constraint.limit);
  return limit > negligible * size ? limit : size;
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

DesignProblem design_problem(const Job& job, const Parameters& typical) {
  DesignProblem problem{.machine = family_of(job),
                        .space = design_space(job),
                        .objective = job.optimum.objective,
                        .constraints = constraints_of(job),
                        .fields = job.optimum.objective.fields,
                        .scales = {1},
                        .free = {}};
  const std::vector<Field> constrained = fields_of(problem.constraints);
  problem.fields.insert(problem.fields.end(), constrained.begin(), constrained.end());
  const VectorXd values = quantities(problem, problem.machine, typical);
  problem.scales[0] = magnitude(magnitude_at(problem, typical));
  for (std::size_t i = 0; i < problem.constraints.size(); ++i)
    problem.scales.push_back(
        scale_of(problem.constraints[i], job.scene, values(static_cast<Index>(i) + 1)));
  for (Index d = 0; d < problem.space.size(); ++d)
    if (problem.space.lower(d) < problem.space.upper(d)) problem.free.push_back(d);
  return problem;
}

double scale_of(const DesignSpace& space, Index parameter) {
  const double lower = space.lower(parameter), upper = space.upper(parameter);
  return std::max(std::abs(lower + upper), upper - lower) / 2;
}

VectorXd to_scaled(const DesignProblem& problem, const Parameters& parameters) {
  VectorXd x(std::ssize(problem.free));
  for (Index i = 0; const Index d : problem.free)
    x(i++) = parameters(d) / scale_of(problem.space, d);
  return x;
}

Parameters to_parameters(const DesignProblem& problem, const VectorXd& scaled) {
  Parameters parameters = problem.space.lower;
  for (Index i = 0; const Index d : problem.free)
    parameters(d) = scaled(i++) * scale_of(problem.space, d);
  return parameters;
}

Domain allowed(const DesignProblem& problem, const Parameters& units) {
  constexpr double step = 0.02;  // beyond which no difference reaches, in scales
  Domain domain{Parameters::Constant(units.size(), -HUGE_VAL),
                Parameters::Constant(units.size(), HUGE_VAL)};
  for (Index d = length_count; const Variable& variable : problem.machine.variables) {
    const double reach = step * scale_of(problem.space, d);
    if (!allows(variable, variable.lower - reach)) domain.lower(d) = variable.lower / units(d);
    if (!allows(variable, variable.upper + reach)) domain.upper(d) = variable.upper / units(d);
    ++d;
  }
  return domain;
}

MatrixXd quantities(const DesignProblem& problem, const MachineFamily& machine,
                    const MatrixXd& parameters, Accuracy accuracy) {
  const MatrixXd fields = field_values(machine, accuracy, parameters, problem.fields);
  MatrixXd values(1 + problem.constraints.size(), parameters.cols());
  for_each_design(machine, parameters, problem.fields, fields,
                  [&](Index column, const Operands& operands) {
                    values(0, column) = problem.objective.value(operands);
                    for (Index row = 1; const Constraint& constraint : problem.constraints)
                      values(row++, column) = constraint.expression.value(operands);
                  });
  return values;
}

MatrixXd values_at(const DesignProblem& problem, const MatrixXd& parameters, Accuracy accuracy) {
  MatrixXd values = quantities(problem, problem.machine, parameters, accuracy);
  values.row(0) /= problem.scales[0];
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const Constraint& constraint = problem.constraints[i];
    auto row = values.row(static_cast<Index>(i) + 1);
    row = row.unaryExpr([&](double v) { return violation(constraint, v) / problem.scales[i + 1]; });
  }
  return values;
}

double magnitude_at(const DesignProblem& problem, const Parameters& parameters) {
  const auto& fields = problem.objective.fields;
  const MatrixXd values = field_values(problem.machine, Accuracy::high, parameters, fields);
  double magnitude = 0;
  for_each_design(problem.machine, parameters, fields, values,
                  [&](Index, const Operands& operands) {
                    magnitude = problem.objective.amount(operands).magnitude;
                  });
  return magnitude / problem.scales[0];
}

NonlinearProgram program_of(const DesignProblem& problem, const std::vector<Deviation>& deviations,
                            Aggregate aggregate, std::uint64_t& integrated, Accuracy accuracy) {
  const auto objectives =
      aggregate == Aggregate::mean
          ? 1
          : std::ranges::count_if(deviations, [](const Deviation& d) { return d.weight > 0; });
  const auto constrained = std::ranges::count_if(deviations, &Deviation::constrained);
  const auto fields = std::ssize(problem.constraints), count = std::ssize(deviations);
  const Index constraints = fields * constrained + std::ssize(problem.space.limits);
  const auto functions = [=, &integrated](const MatrixXd& points) {
    MatrixXd nominal(problem.space.size(), points.cols());
    for (Index p = 0; p < points.cols(); ++p)
      nominal.col(p) = to_parameters(problem, points.col(p));
    MatrixXd parameters(nominal.rows(), points.cols() * count);
    for (Index p = 0, column = 0; p < points.cols(); ++p)
      for (const Deviation& d : deviations) parameters.col(column++) = nominal.col(p) + d.by;
    integrated += static_cast<std::uint64_t>(parameters.cols());
    const MatrixXd values = values_at(problem, parameters, accuracy);
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
    }
    result.bottomRows(std::ssize(problem.space.limits)) = space_excesses(problem, nominal);
    return result;
  };
  Parameters scales(problem.space.size());
  for (Index d = 0; d < scales.size(); ++d) scales(d) = scale_of(problem.space, d);
  const Domain domain = allowed(problem, scales);
  return {functions,
          objectives,
          constraints,
          to_scaled(problem, problem.space.lower),
          to_scaled(problem, problem.space.upper),
          std::ranges::count_if(problem.free, [](Index d) { return d < length_count; }),
          {domain.lower(problem.free), domain.upper(problem.free)}};
}

NonlinearProgram nominal_program(const DesignProblem& problem, std::uint64_t& integrated,
                                 Accuracy accuracy) {
  return program_of(problem, {{Parameters::Zero(problem.space.size()), 1, true}}, Aggregate::worst,
                    integrated, accuracy);
}

std::array<IntervalEnd, 2> interval(const DesignProblem& problem, const Parameters& parameters,
                                    Index parameter) {
  const DesignSpace& space = problem.space;
  const auto limits = problem.constraints.size() + space.limits.size();
  std::array<IntervalEnd, 2> ends{{{-HUGE_VAL, 0}, {HUGE_VAL, 0}}};
  const auto found = std::ranges::find(problem.free, parameter);
  if (found != problem.free.end()) {
    const auto place = limits + static_cast<std::size_t>(found - problem.free.begin());
    ends = {
        {{space.lower(parameter), place}, {space.upper(parameter), place + problem.free.size()}}};
  }
  const auto excess_at = [&](double value, Index limit) {
    Parameters other = parameters;
    other(parameter) = value;
    return space_excesses(problem, other)(limit, 0);
  };
  const double here = parameters(parameter), reach = scale_of(space, parameter);
  for (const std::size_t side : {0u, 1u})
    for (Index limit = 0; limit < std::ssize(space.limits); ++limit) {
      double within = here;
      double beyond =
          std::isfinite(ends[side].value) ? ends[side].value : here + (side == 0 ? -reach : reach);
      if (!(excess_at(beyond, limit) > feasibility_tolerance)) continue;
      for (int i = 0; i < 60; ++i) {
        const double middle = (within + beyond) / 2;
        (excess_at(middle, limit) > 0 ? beyond : within) = middle;
      }
      ends[side] = {within, problem.constraints.size() + static_cast<std::size_t>(limit)};
    }
  return ends;
}

std::vector<Limit> limits(const DesignProblem& problem) {
  const DesignSpace& space = problem.space;
  std::vector<Limit> all;
  const double objective = problem.scales[0];
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const Constraint& c = problem.constraints[i];
    all.push_back(
        {to_text(c), c.expression.unit, (c.is_upper ? 1 : -1) * objective / problem.scales[i + 1]});
  }
  for (const SpaceLimit& limit : space.limits)
    all.push_back({limit.text, "m", objective / problem.machine.scene.fulcrum_height});
  for (const bool upper : {false, true})
    for (const Index d : problem.free) {
      const auto i = static_cast<std::size_t>(d);
      all.push_back({fmt::format("{} {} {:.9g}", space.names[i],
                                 upper ? "<=" : ">=", (upper ? space.upper : space.lower)(d)),
                     space.units[i], (upper ? 1 : -1) * objective / scale_of(space, d)});
    }
  return all;
}

}  // namespace trebsweep
