#include "trebsweep/optimum/sensitivity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/rules.hpp"
#include "trebsweep/optimum/derivatives.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int levels = 12;

std::optional<double> number_of(const Job& job, const Key& key) {
  double value = 0;
  return parse_number(key.get(job), value) ? std::optional(value) : std::nullopt;
}

/// The objective and the constrained expressions at parameters, the excesses over the limits of the
/// space, and the bounds, with another value of a key; NaN if the key does not allow it.
VectorXd values_with(const Job& job, const Key& key, double value, const DesignProblem& problem,
                     const Parameters& parameters) {
  VectorXd all = VectorXd::Constant(1 + std::ssize(limits(problem)), std::nan(""));
  Job varied = job;
  DesignSpace space;
  try {
    key.set(varied, fmt::format("{}", value));
    space = design_space(varied);
  } catch (const std::runtime_error&) {  // an InputError or NoOptimum
    return all;
  }
  const Index functions = 1 + std::ssize(problem.constraints);
  varied.solver.recorded = problem.machine.solver.recorded;
  all.head(functions) = quantities(problem, family_of(varied), parameters);
  Index i = functions;
  for (const SpaceLimit& limit : problem.space.limits)
    all(i++) = limit.excess(varied.scene, to_design(parameters));
  for (const auto* bound : {&space.lower, &space.upper})
    for (const Index d : problem.free) all(i++) = (*bound)(d);
  return all;
}

/// The sensitivity that a part of the swing contributes.
Sensitivity sensitivity(const Job& job, const std::string& name, const Parameters& parameters,
                        const PartOptimum& part) {
  const auto& [problem, weight, derivatives] = part;
  const auto& key = *std::ranges::find(job_keys(), name, &Key::name);
  const double value = number_of(job, key).value();
  const auto at = [&](double v) { return values_with(job, key, v, problem, parameters); };
  const VectorXd here = at(value);

  double step = accurate_steps.largest * std::abs(value);
  if (value == 0)  // so that the objective changes by a thousandth
    for (step = 1e-6; step < 1e9; step *= 4)
      if (!(std::abs(at(step)(0) - here(0)) < 1e-3 * std::abs(here(0)))) break;
  const bool one_sided = value == 0 && std::isnan(at(-step)(0));

  std::array<VectorXd, levels> quotients;
  for (int k = 0; k < levels; ++k) {
    const double h = std::ldexp(step, -k);
    quotients[static_cast<std::size_t>(k)] =
        one_sided ? VectorXd((at(h) - here) / h)
                  : VectorXd((at(value + h) - at(value - h)) / (2 * h));
  }
  const auto derivative = [&](Index row) {
    std::array<double, levels> q;
    std::ranges::transform(quotients, q.begin(), [&](const VectorXd& v) { return v(row); });
    const Derivative found = extrapolate(q, one_sided ? 1 : 2);
    // A difference quotient across a jump grows as its step becomes shorter. A field at its limit
    // may be zero.
    const auto f = static_cast<std::size_t>(row);
    const double size =
        std::max(std::abs(here(row)), f < problem.scales.size() ? problem.scales[f] : 0);
    const double doubtful = 0.05 * std::abs(found.value) + 1e-6 * size / std::abs(step);
    return found.error <= doubtful ? found.value : std::nan("");
  };

  // derivatives(i) is that of the optimum when limit i grows. An expression or excess that grows by
  // as much leaves that much less to its limit.
  const Index functions = 1 + std::ssize(problem.constraints) + std::ssize(problem.space.limits);
  double of_optimum = weight == 0 ? 0 : weight * derivative(0);
  for (Index i = 0; i < derivatives.size(); ++i)
    if (derivatives(i) != 0)
      of_optimum += (i + 1 < functions ? -1 : 1) * derivatives(i) * derivative(i + 1);
  return {value, derivative(0), of_optimum};
}

}  // namespace

std::vector<std::string> numeric_scene_keys(const Job& job) {
  const auto unused = unused_keys(job);
  std::vector<std::string> names;
  for (const Key& key : job_keys()) {
    const auto value = number_of(job, key);
    if (key.section() != "scene" || !value || unused.contains(key.name)) continue;
    if (std::ranges::count(job.optimum.variables, key.name, &Variable::key) > 0) continue;
    if (*value == 0 && is_absent_at_zero(key.name)) continue;
    if (key.name == "scene.sling-damping" && job.scene.sling_stiffness == 0) continue;
    names.push_back(key.name);
  }
  return names;
}

Sensitivity sensitivity(const Job& job, const std::string& key, const Parameters& parameters,
                        const std::vector<PartOptimum>& parts) {
  constexpr double same = 1e-6;
  const auto heaviest = std::ranges::max_element(parts, {}, &PartOptimum::weight);
  Sensitivity sum = sensitivity(job, key, parameters, *heaviest);
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    if (part == heaviest) continue;
    const Sensitivity other = sensitivity(job, key, parameters, *part);
    const bool is_kink =
        !(std::abs(other.at_design - sum.at_design) <= same * std::abs(sum.at_design));
    if (part->weight > 0 && is_kink) sum.at_design = std::nan("");
    sum.of_optimum += other.of_optimum;
  }
  return sum;
}

}  // namespace trebsweep
