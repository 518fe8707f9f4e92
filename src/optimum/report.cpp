#include "trebsweep/optimum/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/unit.hpp"
#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {
namespace {

/// A number and its unit as they are shown.
struct Quantity {
  double value;
  std::string unit;  ///< with a space before it, or empty
};

Quantity shown(double value, std::string_view unit, UnitSystem units) {
  const auto [name, factor] = shown_unit(unit, units);
  return {value / factor, name.empty() ? "" : " " + name};
}

/// A number with its unit: "1.25 m".
std::string number_text(double value, std::string_view unit, UnitSystem units, int digits) {
  const Quantity quantity = shown(value, unit, units);
  return fmt::format("{:.{}g}{}", quantity.value, digits, quantity.unit);
}

/// The unit of the objective, with a space before it, and by what values are divided to show them.
ShownUnit objective_unit(const OptimumResult& result, UnitSystem units) {
  const auto [unit, factor] = shown_unit(result.objective.unit, units);
  return {unit.empty() ? "" : " " + unit, shown(result.objective).sign * factor};
}

/// A value of the objective.
std::string value_text(const OptimumResult& result, double value, UnitSystem units,
                       int digits = 9) {
  const auto [unit, factor] = objective_unit(result, units);
  return fmt::format("{:.{}g}{}", value / factor, digits, unit);
}

/// An angle in radians and degrees, or in degrees.
std::string angle_text(double angle, UnitSystem units, int digits) {
  if (units != UnitSystem::si) return number_text(angle, "rad", units, digits);
  return fmt::format("{} ({})", number_text(angle, "rad", units, digits),
                     number_text(angle, "rad", UnitSystem::deg, 4));
}

/// A limit such as "range >= 80", whose number is in a unit of the SI. Where that is shown in
/// another, the unit follows.
std::string limit_text(const std::string& limit, const Job& job, UnitSystem units) {
  const std::size_t place = limit.rfind("= ");
  double number = 0;
  if (units == UnitSystem::si || place == std::string::npos ||
      !parse_number(limit.substr(place + 2), number))
    return limit;
  const std::string name = limit.substr(0, limit.find_first_of("<>") - 1);
  const DesignSpace space = design_space(job);
  std::string unit = "m";  // of a limit of the space
  if (const auto found = std::ranges::find(space.names, name); found != space.names.end())
    unit = space.units[static_cast<std::size_t>(found - space.names.begin())];
  for (const Constraint& constraint : constraints_of(searched_job(job)))
    if (constraint.expression.text == name) unit = constraint.expression.unit;
  return limit.substr(0, place + 2) + number_text(number, unit, units, 9);
}

/// The words for a smaller and a larger value.
using Comparatives = std::array<const char*, 2>;
constexpr Comparatives shorter_or_longer{"shorter", "longer"}, less_or_more{"less", "more"};

/// By how much a length or another quantity may be off.
std::string allowance_text(const Allowance& allowance, const std::string& unit,
                           const Comparatives& words, const Job& job, UnitSystem units) {
  const auto side = [&](double amount, const char* word, const std::string& limit) {
    const std::string reached =
        limit.empty() ? "" : fmt::format(" ({})", limit_text(limit, job, units));
    if (std::isinf(amount))
      return fmt::format("any {} {}",
                         unit == "m"     ? "length"
                         : unit == "rad" ? "angle"
                                         : "value",
                         word);
    if (unit == "rad") return fmt::format("{} {}{}", angle_text(amount, units, 4), word, reached);
    const auto [value, name] = shown(amount, unit, units);
    if (unit == "m") return fmt::format("{:.4f}{} {}{}", value, name, word, reached);
    return fmt::format("{:.4g}{} {}{}", value, name, word, reached);
  };
  return fmt::format("{} or {}", side(allowance.less, words[0], allowance.less_limit),
                     side(allowance.more, words[1], allowance.more_limit));
}

std::string pin_allowance_text(const OptimumResult& result, const Job& job, UnitSystem units) {
  if (!result.pin_allowance) return "";
  return fmt::format("           pin: {}\n",
                     allowance_text(*result.pin_allowance, "rad", less_or_more, job, units));
}

/// Whether the job gives all lengths.
bool is_given(const Job& job) {
  const DesignSpace space = design_space(job);
  return space.lower == space.upper;
}

/// What each limit is worth.
std::string limits_text(const OptimumResult& result, const Job& job, UnitSystem units) {
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
  const auto [unit, of_value] = objective_unit(result, units);
  std::string text;
  for (const auto& [constraint, limit_unit, multiplier] : result.active) {
    const auto [by, factor] = shown_unit(limit_unit, units);
    text += fmt::format("{:10} {}: {:+.6g}{}{}{}{}\n", text.empty() ? "limits" : "",
                        limit_text(constraint, job, units), multiplier * factor / of_value, unit,
                        by.empty() ? "" : " per ", by, of);
  }
  if (result.has_kink)
    text += "kink       extremes of the swing are equal, so the objective has no gradient here\n";
  return text;
}

/// Why the optimum is not the design with the largest value.
std::string unsafe_text(const OptimumResult& result, const Job& job, UnitSystem units) {
  if (!result.unsafe) return "";
  const auto& [parameters, value] = *result.unsafe;
  const double deviation = job.optimum.deviation;
  return fmt::format(
      "           the best design found that tolerates lengths off by up to {}:\n"
      "           the {} jumps or changes steeply, or a constraint jumps, next to {} at {}\n",
      deviation > 0 ? number_text(deviation, "m", units, 6) : "0.1 %", shown(result.objective).text,
      value_text(result, value, units), to_text(parameters, job.optimum.variables, units));
}

/// A field at the optimum, if it is known: "the_name 1.25 m".
std::string field_text(const OptimumResult& result, Field field, const char* name,
                       UnitSystem units) {
  const auto found = std::ranges::find(result.values, field, &BuildValue::field);
  if (found == result.values.end()) return "";
  const double value = std::abs(found->value) < 1e-9 ? 0 : found->value;  // rounding errors
  if (field == Field::pin_angle) return fmt::format("{} {}", name, angle_text(value, units, 10));
  return fmt::format("{} {}", name, number_text(value, info(field).units, units, 6));
}

/// What a builder needs to know, a line for each kind of quantity.
std::string build_text(const OptimumResult& result, UnitSystem units) {
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
      if (const std::string part = field_text(result, field, name, units); !part.empty())
        parts.push_back(part);
    if (!parts.empty()) text += fmt::format("{:10} {}\n", label, fmt::join(parts, ", "));
  }
  if (const auto& wind = result.range_with_wind)
    text += fmt::format("wind       range {} with {} less wind, {} with more\n",
                        number_text(wind->less, "m", units, 6),
                        number_text(WindRange::speed, "m/s", units, 6),
                        number_text(wind->more, "m", units, 6));
  return text;
}

/// The ends of the job's axes beyond which lengths that are off reach: "r1 < 0.52 m".
std::vector<std::string> ends_crossed(const OptimumResult& result, const Job& job,
                                      UnitSystem units) {
  const DesignSpace space = design_space(job);
  const std::array axes{&job.lattice.r1, &job.lattice.r3, &job.lattice.r2};
  const double deviation = job.optimum.deviation;
  std::vector<std::string> crossed;
  for (std::size_t d = 0; d < axes.size(); ++d) {
    const auto i = static_cast<Eigen::Index>(d);
    if (!*axes[d] || !(space.lower(i) < space.upper(i))) continue;
    const double length = result.parameters(i);
    if (length - deviation < space.lower(i))
      crossed.push_back(
          fmt::format("{} < {}", space.names[d], number_text(space.lower(i), "m", units, 9)));
    if (length + deviation > space.upper(i))
      crossed.push_back(
          fmt::format("{} > {}", space.names[d], number_text(space.upper(i), "m", units, 9)));
  }
  return crossed;
}

std::string robustness_text(const OptimumResult& result, const Job& job, UnitSystem units) {
  if (!result.robustness) return "";
  const auto [worst, expected, unreleased] = *result.robustness;
  const std::string values =
      unreleased
          ? fmt::format("no worst value, {} has no release",
                        to_text(*unreleased, job.optimum.variables, units))
          : fmt::format("worst {:.9g}, expected {}", worst / objective_unit(result, units).factor,
                        value_text(result, expected, units));
  std::string text = fmt::format("deviation  lengths off by up to {}: {}\n",
                                 number_text(job.optimum.deviation, "m", units, 6), values);
  if (const auto crossed = ends_crossed(result, job, units); !crossed.empty())
    text +=
        fmt::format("           some of them are beyond an axis: {}\n", fmt::join(crossed, ", "));
  return text;
}

/// How precisely to build.
std::string precision_text(const OptimumResult& result, const Job& job, UnitSystem units) {
  const DesignSpace space = design_space(job);
  std::vector<std::size_t> order{0, 2, 1};  // r1, r2, r3
  for (std::size_t d = order.size(); d < space.names.size(); ++d) order.push_back(d);
  std::string text;
  for (const std::size_t d : order) {
    const auto i = static_cast<Eigen::Index>(d);
    const auto& words = d < length_count ? shorter_or_longer : less_or_more;
    text += fmt::format("{:10} {}: {}", text.empty() ? "1 % lost" : "", space.names[d],
                        allowance_text(result.allowances[d], space.units[d], words, job, units));
    const double value = objective_unit(result, units).factor;
    const double by = shown_unit(space.units[d], units).factor;
    if (!std::isnan(result.gradient(i)))
      text += fmt::format("; gradient {:+.4g}, curvature {:+.4g}",
                          result.gradient(i) * by / value + 0.0,  // no -0
                          result.hessian(i, i) * by * by / value + 0.0);
    text += "\n";
  }
  return text + pin_allowance_text(result, job, units);
}

/// A change of the value; "-" where there is no derivative.
std::string change_text(double change) {
  return std::isnan(change) ? "-" : fmt::format("{:+.6g}", change + 0.0);  // no -0
}

std::string sensitivities_text(const OptimumResult& result, UnitSystem units) {
  const double of_value = objective_unit(result, units).factor;
  std::string text = fmt::format("{:34}{:>18}", "change of the value", "lengths kept");
  const bool both = !std::ranges::all_of(
      result.sensitivities, [](const auto& s) { return std::isnan(s.second.of_optimum); });
  text += both ? fmt::format("{:>18}\n", "lengths optimal") : "\n";
  for (const auto& [name, sensitivity] : result.sensitivities) {
    const Key& key = *std::ranges::find(job_keys(), "scene." + name, &Key::name);
    const auto& [value, at_design, of_optimum] = sensitivity;
    const auto [unit, factor] = shown_unit(key.unit, units);
    const double change = (value == 0 ? factor : 0.01 * std::abs(value)) / of_value;
    const std::string label =
        value == 0 ? fmt::format("{} per {}", name, unit) : fmt::format("{} + 1 %", name);
    text += fmt::format("{:34}{:>18}", label, change_text(change * at_design));
    text += both ? fmt::format("{:>18}\n", change_text(change * of_optimum)) : "\n";
  }
  return text;
}

std::string maxima_text(const OptimumResult& result, const Job& job, UnitSystem units) {
  const auto& maxima = result.maxima;
  std::string text =
      fmt::format("maxima     {} found from {} start{}; {} led to the optimum\n", maxima.size(),
                  result.starts, result.starts == 1 ? "" : "s", maxima.front().starts);
  const auto next = std::find_if(maxima.begin() + 1, maxima.end(), [&](const LocalMaximum& m) {
    return m.parameters != result.parameters;  // the best safe one
  });
  if (next != maxima.end())
    text += fmt::format("           the next best is {} at {}\n",
                        value_text(result, next->value, units),
                        to_text(next->parameters, job.optimum.variables, units));
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

std::vector<std::string> warnings(const OptimumResult& result, const Job& job, UnitSystem units) {
  std::vector<std::string> texts;
  for (const BuildProblem& problem : problems(result, job)) texts.push_back(problem.text);
  if (result.objective.distance < 0 && !result.is_on_target)
    texts.push_back(fmt::format("the target is not met: {} is {} at best",
                                shown(result.objective).text,
                                value_text(result, result.value, units, 6)));
  return texts;
}

std::string to_text(const OptimumResult& result, const Job& given_job, UnitSystem units) {
  const Job job = found_job(result, given_job);
  const Solver solver = solver_of("vern8", 1e-13, job.solver);
  std::string text =
      fmt::format("scene      {}\nsolver     {}\n", scene_text(job), solver_text(solver));
  const ShownObjective objective = shown(result.objective);
  text += fmt::format("optimum    {}{} {}, error {:.1g}\n", objective.sign < 0 ? "least " : "",
                      objective.text, value_text(result, result.value, units, 10),
                      shown(result.error, result.objective.unit, units).value);
  text += unsafe_text(result, job, units);
  text +=
      fmt::format("design     {}, released at {:.8g} s\n",
                  to_text(result.parameters, job.optimum.variables, units), result.release_time);
  for (const std::string& warning : warnings(result, job, units))
    text += fmt::format("warning    {}\n", warning);
  text += build_text(result, units) + limits_text(result, job, units);
  text += precision_text(result, job, units) + robustness_text(result, job, units);
  text += maxima_text(result, job, units);
  text += fmt::format("designs    {}", result.designs);
  if (result.coarse_increment > 0)
    text += fmt::format(", those of the coarse sweep with a spacing of {}",
                        number_text(result.coarse_increment, "m", units, 6));
  text += fmt::format("\nseconds    {:.2f}\n", result.seconds);
  return result.is_on_target ? text : text + "\n" + sensitivities_text(result, units);
}

}  // namespace trebsweep
