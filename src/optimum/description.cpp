#include "trebsweep/optimum/description.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trebsweep/optimum/derivatives.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Gradient and Hessian of the objective with respect to all parameters.
void add_derivatives(const DesignProblem& problem, OptimumResult& result) {
  VectorXd unit = result.parameters;
  for (Index d = length_count; d < unit.size(); ++d) unit(d) = scale_of(problem.space, d);
  const auto functions = [&](const MatrixXd& points) {
    result.designs += static_cast<std::uint64_t>(points.cols());
    const MatrixXd values = values_at(problem, unit.asDiagonal() * points);
    return MatrixXd(values.row(0) * problem.scales.front());
  };
  const Expansion expansion = expand(functions, result.parameters.cwiseQuotient(unit),
                                     accurate_steps, true, allowed(problem, unit));
  const VectorXd per_unit = unit.cwiseInverse();
  result.gradient = expansion.gradients.row(0).transpose().cwiseProduct(per_unit);
  result.hessian = per_unit.asDiagonal() * expansion.hessians.front() * per_unit.asDiagonal();
}

/// The value of the objective at the optimum, its error and the release time.
void add_value(const DesignProblem& problem, OptimumResult& result) {
  std::vector<Field> fields = result.objective.fields;
  fields.push_back(Field::release_time);
  const MachineFamily machine = at(problem.machine, result.parameters);
  const Design<double> design = to_design(result.parameters);
  const VectorXd values =
      field_values(problem.machine, Accuracy::high, result.parameters, fields).col(0);
  const auto exact = reference_values(machine.scene, design, machine.solver, fields);
  VectorXd exact_values(values.size());
  std::ranges::transform(exact, exact_values.begin(), &ReferenceValue::value);
  const auto objective = [&](const VectorXd& of_fields) {
    return result.objective.value(
        {machine.scene, design, fields, {of_fields.data(), fields.size()}});
  };
  result.value = objective(values);
  result.release_time = values(values.size() - 1);
  result.error = std::abs(result.value - objective(exact_values));
  for (Index i = 0; i < values.size() - 1; ++i) {  // to first order
    VectorXd off = exact_values;
    off(i) += exact[static_cast<std::size_t>(i)].bound;
    result.error += std::abs(objective(off) - objective(exact_values));
  }
}

/// The fields that a builder needs to know, as far as the scene has them.
std::vector<BuildValue> build_values(const DesignProblem& problem, const Parameters& parameters) {
  const Scene scene = at(problem.machine, parameters).scene;
  std::vector<Field> fields{Field::speed,
                            Field::range,
                            Field::efficiency,
                            Field::release_time,
                            Field::arm_angle,
                            Field::pin_angle,
                            Field::impact_speed,
                            Field::ground_clearance,
                            Field::tip_clearance,
                            Field::counterweight_clearance,
                            Field::projectile_clearance,
                            Field::least_sling_tension,
                            Field::peak_sling_tension};
  if (scene.counterweight_hanger > 0) {
    fields.push_back(Field::least_hanger_tension);
    fields.push_back(Field::peak_hanger_tension);
  }
  fields.push_back(Field::peak_axle_load);
  if (has_beam_stress(scene)) fields.push_back(Field::peak_beam_stress);
  const VectorXd values = field_values(problem.machine, Accuracy::high, parameters, fields);
  std::vector<BuildValue> all;
  for (std::size_t i = 0; i < fields.size(); ++i)
    all.push_back({fields[i], values(static_cast<Index>(i))});
  return all;
}

/// The least and the largest value of each parameter, with the others as they are.
std::vector<std::array<double, 2>> bounds(const DesignProblem& problem,
                                          const Parameters& parameters) {
  std::vector<std::array<double, 2>> all;
  for (Index d = 0; d < parameters.size(); ++d) {
    const auto [low, high] = interval(problem, parameters, d);
    all.push_back({std::max(problem.space.lower(d), low.value),
                   std::min(problem.space.upper(d), high.value)});
  }
  return all;
}

/// The range in other winds of a projectile that feels drag, released by the same pin.
std::optional<WindRange> range_with_wind(const DesignProblem& problem,
                                         const Parameters& parameters) {
  const MachineFamily machine = at(problem.machine, parameters);
  if (machine.scene.projectile_diameter == 0) return std::nullopt;
  const auto value = [&](Field field, const Scene& scene, const Solver& solver) {
    return field_values({scene, solver, {}}, Accuracy::high, parameters.head(length_count),
                        {&field, 1})(0);
  };
  Solver pinned = machine.solver;
  pinned.release = Release::pin;
  pinned.pin_angle = value(Field::pin_angle, machine.scene, machine.solver);
  const auto range_in = [&](double wind) {
    Scene scene = machine.scene;
    scene.wind += wind;
    return value(Field::range, scene, pinned);
  };
  const WindRange range{range_in(-WindRange::speed), range_in(WindRange::speed)};
  return std::isfinite(range.less + range.more) ? std::optional(range) : std::nullopt;
}

}  // namespace

void describe(const DesignProblem& problem, double deviation, OptimumResult& result) {
  add_value(problem, result);
  result.values = build_values(problem, result.parameters);
  add_derivatives(problem, result);
  if (result.is_on_target || result.has_kink) {
    result.gradient.fill(std::numeric_limits<double>::quiet_NaN());
    result.hessian.fill(std::numeric_limits<double>::quiet_NaN());
  }
  result.bounds = bounds(problem, result.parameters);
  result.allowances = allowances(problem, result.parameters, result.designs);
  result.pin_allowance = pin_allowance(problem, result.parameters, result.designs);
  if (result.pin_allowance) result.range_with_wind = range_with_wind(problem, result.parameters);
  if (deviation > 0)
    result.robustness = robustness(problem, result.parameters, deviation, result.designs);
}

}  // namespace trebsweep
