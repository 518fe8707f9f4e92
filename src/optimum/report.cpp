#include "trebsweep/optimum/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/optimum/design_space.hpp"

namespace trebsweep {
namespace {

std::string unit_of(const OptimumResult& result) { return unit_text(result.objective.unit); }

/// A unit after a number: " m/s", or nothing for a number without a unit.
std::string after_number(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

/// The unit of a derivative: " m/s per m".
std::string per(const std::string& unit, const std::string& by) {
  return after_number(unit) + (by.empty() ? "" : " per " + by);
}

/// An angle in radians and degrees.
std::string angle_text(double angle, int digits) {
  return fmt::format("{:.{}g} rad ({:.4g} deg)", angle, digits,
                     angle / boost::math::double_constants::degree);
}

/// The words for a smaller and a larger value.
using Comparatives = std::array<const char*, 2>;
constexpr Comparatives shorter_or_longer{"shorter", "longer"}, less_or_more{"less", "more"};

/// By how much a length or another quantity may be off.
std::string allowance_text(const Allowance& allowance, const std::string& unit,
                           const Comparatives& words) {
  const auto side = [&](double amount, const char* word, const std::string& limit) {
    const std::string reached = limit.empty() ? "" : fmt::format(" ({})", limit);
    if (std::isinf(amount))
      return fmt::format("any {} {}",
                         unit == "m"     ? "length"
                         : unit == "rad" ? "angle"
                                         : "value",
                         word);
    if (unit == "rad") return fmt::format("{} {}{}", angle_text(amount, 4), word, reached);
    if (unit == "m") return fmt::format("{:.4f} m {}{}", amount, word, reached);
    return fmt::format("{:.4g}{} {}{}", amount, after_number(unit), word, reached);
  };
  return fmt::format("{} or {}", side(allowance.less, words[0], allowance.less_limit),
                     side(allowance.more, words[1], allowance.more_limit));
}

std::string pin_allowance_text(const OptimumResult& result) {
  if (!result.pin_allowance) return "";
  return fmt::format("           pin: {}\n",
                     allowance_text(*result.pin_allowance, "rad", less_or_more));
}

/// Whether the job gives all lengths.
bool is_given(const Job& job) {
  const DesignSpace space = design_space(job);
  return space.lower == space.upper;
}

/// What each limit is worth.
std::string limits_text(const OptimumResult& result, const Job& job) {
  if (result.is_on_target) return "limits     none: the target is met\n";
  if (result.unsafe) return "limits     unknown: the optimum is not a stationary point\n";
  if (!result.converged)
    return "limits     unknown: the objective or a constraint has a kink or a jump there,\n"
           "           or designs next to it have no release\n";
  if (is_given(job)) return "limits     not searched: all lengths are given\n";
  if (result.active.empty()) return "limits     none is active\n";
  const char* const of = job.optimum.robust == Robust::worst      ? " (of the worst value)"
                         : job.optimum.robust == Robust::expected ? " (of the expected value)"
                                                                  : "";
  std::string text;
  for (const auto& [constraint, units, multiplier] : result.active)
    text += fmt::format("{:10} {}: {:+.6g}{}{}\n", text.empty() ? "limits" : "", constraint,
                        multiplier, per(unit_of(result), unit_text(units)), of);
  if (result.has_kink)
    text += "kink       extremes of the swing are equal: the objective has no gradient\n";
  return text;
}

/// Why the optimum is not the design with the largest value.
std::string unsafe_text(const OptimumResult& result, const Job& job) {
  if (!result.unsafe) return "";
  const auto& [parameters, value] = *result.unsafe;
  const double deviation = job.optimum.deviation;
  return fmt::format(
      "           the best design found that tolerates lengths off by up to {}:\n"
      "           the {} jumps or falls steeply, or a constraint jumps, next to {:.9g}{} at {}\n",
      deviation > 0 ? fmt::format("{} m", deviation) : "0.1 %", result.objective.text, value,
      after_number(unit_of(result)), to_text(parameters, job.optimum.variables));
}

/// A field at the optimum, if it is known: "the_name 1.25 m".
std::string value_text(const OptimumResult& result, Field field, const char* name) {
  const auto found = std::ranges::find(result.values, field, &BuildValue::field);
  if (found == result.values.end()) return "";
  const double value = std::abs(found->value) < 1e-9 ? 0 : found->value;  // rounding errors
  if (field == Field::pin_angle) return fmt::format("{} {}", name, angle_text(value, 10));
  return fmt::format("{} {:.6g}{}", name, value, after_number(unit_text(info(field).units)));
}

/// What a builder needs to know, a line for each kind of quantity.
std::string build_text(const OptimumResult& result) {
  using Names = std::vector<std::pair<Field, const char*>>;
  const std::array<std::pair<const char*, Names>, 4> lines{
      {{"at release",
        {{Field::speed, "speed"}, {Field::range, "range"}, {Field::pin_angle, "pin angle"}}},
       {"clearance",
        {{Field::tip_clearance, "arm's tip"},
         {Field::counterweight_clearance, "counterweight"},
         {Field::projectile_clearance, "projectile"}}},
       {"tension",
        {{Field::least_sling_tension, "sling at least"},
         {Field::least_hanger_tension, "hanger at least"}}},
       {"peak load",
        {{Field::peak_sling_tension, "sling"},
         {Field::peak_hanger_tension, "hanger"},
         {Field::peak_axle_load, "axle"},
         {Field::peak_beam_stress, "beam"}}}}};
  std::string text;
  for (const auto& [label, names] : lines) {
    std::vector<std::string> parts;
    for (const auto& [field, name] : names)
      if (const std::string part = value_text(result, field, name); !part.empty())
        parts.push_back(part);
    if (!parts.empty()) text += fmt::format("{:10} {}\n", label, fmt::join(parts, ", "));
  }
  if (const auto& wind = result.range_with_wind)
    text += fmt::format("wind       range {:.6g} m with {} m/s less wind, {:.6g} m with more\n",
                        wind->less, WindRange::speed, wind->more);
  return text;
}

/// The ends of the job's axes beyond which lengths that are off reach: "r1 < 0.52 m".
std::vector<std::string> ends_crossed(const OptimumResult& result, const Job& job) {
  const DesignSpace space = design_space(job);
  const std::array axes{&job.lattice.r1, &job.lattice.r3, &job.lattice.r2};
  const double deviation = job.optimum.deviation;
  std::vector<std::string> crossed;
  for (std::size_t d = 0; d < axes.size(); ++d) {
    const auto i = static_cast<Eigen::Index>(d);
    if (!*axes[d] || !(space.lower(i) < space.upper(i))) continue;
    const double length = result.parameters(i);
    if (length - deviation < space.lower(i))
      crossed.push_back(fmt::format("{} < {:.9g} m", space.names[d], space.lower(i)));
    if (length + deviation > space.upper(i))
      crossed.push_back(fmt::format("{} > {:.9g} m", space.names[d], space.upper(i)));
  }
  return crossed;
}

std::string robustness_text(const OptimumResult& result, const Job& job) {
  if (!result.robustness) return "";
  const auto [worst, expected, unreleased] = *result.robustness;
  const std::string values = unreleased ? fmt::format("no worst value, {} has no release",
                                                      to_text(*unreleased, job.optimum.variables))
                                        : fmt::format("worst {:.9g}, expected {:.9g}{}", worst,
                                                      expected, after_number(unit_of(result)));
  std::string text =
      fmt::format("deviation  lengths off by up to {} m: {}\n", job.optimum.deviation, values);
  if (const auto crossed = ends_crossed(result, job); !crossed.empty())
    text +=
        fmt::format("           some of them are beyond an axis: {}\n", fmt::join(crossed, ", "));
  return text;
}

/// How precisely to build.
std::string precision_text(const OptimumResult& result, const Job& job) {
  const DesignSpace space = design_space(job);
  std::vector<std::size_t> order{0, 2, 1};  // r1, r2, r3
  for (std::size_t d = order.size(); d < space.names.size(); ++d) order.push_back(d);
  std::string text;
  for (const std::size_t d : order) {
    const auto i = static_cast<Eigen::Index>(d);
    const auto& words = d < length_count ? shorter_or_longer : less_or_more;
    text += fmt::format("{:10} {}: {}", text.empty() ? "1 % lost" : "", space.names[d],
                        allowance_text(result.allowances[d], space.units[d], words));
    if (!std::isnan(result.gradient(i)))
      text += fmt::format("; gradient {:+.4g}, curvature {:+.4g}", result.gradient(i),
                          result.hessian(i, i));
    text += "\n";
  }
  return text + pin_allowance_text(result);
}

std::string sensitivities_text(const OptimumResult& result) {
  std::string text = fmt::format("{:34}{:>18}", "change of the value", "lengths kept");
  const bool both = !std::ranges::all_of(
      result.sensitivities, [](const auto& s) { return std::isnan(s.second.of_optimum); });
  text += both ? fmt::format("{:>18}\n", "lengths optimal") : "\n";
  for (const auto& [name, sensitivity] : result.sensitivities) {
    const Key& key = *std::ranges::find(job_keys(), "scene." + name, &Key::name);
    const auto& [value, at_design, of_optimum] = sensitivity;
    const double change = value == 0 ? 1 : 0.01 * std::abs(value);
    const std::string label =
        value == 0 ? fmt::format("{} per {}", name, key.unit) : fmt::format("{} + 1 %", name);
    text += fmt::format("{:34}{:>+18.6g}", label, change * at_design);
    text += both ? fmt::format("{:>+18.6g}\n", change * of_optimum) : "\n";
  }
  return text;
}

std::string maxima_text(const OptimumResult& result, const Job& job) {
  const auto& maxima = result.maxima;
  std::string text =
      fmt::format("maxima     {} found from {} start{}; {} led to the optimum\n", maxima.size(),
                  result.starts, result.starts == 1 ? "" : "s", maxima.front().starts);
  if (maxima.size() > 1)
    text += fmt::format("           the next best is {:.9g}{} at {}\n", maxima[1].value,
                        after_number(unit_of(result)),
                        to_text(maxima[1].parameters, job.optimum.variables));
  return text;
}

/// In what the optimum cannot be built: its hanger, or anything if all designs compete.
std::vector<BuildProblem> problems(const OptimumResult& result, const Job& job) {
  std::array<double, build_fields.size()> values;
  std::ranges::transform(build_fields, values.begin(), [&](Field field) {
    const auto found = std::ranges::find(result.values, field, &BuildValue::field);
    return found == result.values.end() ? std::nan("") : found->value;
  });
  return build_problems(job.scene, to_build_values(values));
}

}  // namespace

Job found_job(const OptimumResult& result, const Job& job) {
  return with_variables(job, result.parameters.tail(result.parameters.size() - length_count));
}

std::vector<std::string> warnings(const OptimumResult& result, const Job& job) {
  std::vector<std::string> texts;
  for (const BuildProblem& problem : problems(result, job)) texts.push_back(problem.text);
  if (result.objective.distance < 0 && !result.is_on_target)
    texts.push_back(fmt::format("the target is not met: {} is {:.6g}{} at best",
                                result.objective.text, result.value,
                                after_number(unit_of(result))));
  return texts;
}

std::string to_text(const OptimumResult& result, const Job& given_job) {
  const Job job = found_job(result, given_job);
  const std::string unit = after_number(unit_of(result));
  const Solver solver = solver_of("vern8", 1e-13, job.solver);
  std::string text =
      fmt::format("scene      {}\nsolver     {}\n", scene_text(job), solver_text(solver));
  text += fmt::format("optimum    {} {:.10g}{}, error {:.1g}\n", result.objective.text,
                      result.value, unit, result.error);
  text += unsafe_text(result, job);
  text += fmt::format("design     {}, released at {:.8g} s\n",
                      to_text(result.parameters, job.optimum.variables), result.release_time);
  for (const std::string& warning : warnings(result, job))
    text += fmt::format("warning    {}\n", warning);
  text += build_text(result) + limits_text(result, job) + precision_text(result, job);
  text += robustness_text(result, job);
  text += maxima_text(result, job);
  text += fmt::format("designs    {}", result.designs);
  if (result.coarse_increment > 0)
    text +=
        fmt::format(", those of the coarse sweep with a spacing of {} m", result.coarse_increment);
  text += fmt::format("\nseconds    {:.2f}\n", result.seconds);
  return result.is_on_target ? text : text + "\n" + sensitivities_text(result);
}

}  // namespace trebsweep
