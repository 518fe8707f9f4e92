#include "trebsweep/optimum/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trebsweep/base/number.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/optimum/design_space.hpp"

namespace trebsweep {
namespace {

using Json = nlohmann::ordered_json;

std::string unit_of(const OptimumResult& result) { return unit_text(info(result.objective).units); }

/// A unit after a number: " m/s", or nothing for a number without a unit.
std::string after_number(const std::string& unit) { return unit.empty() ? "" : " " + unit; }

/// The unit of a derivative: " m/s per m".
std::string per(const std::string& unit, const std::string& by) {
  return after_number(unit) + (by.empty() ? "" : " per " + by);
}

std::string allowance_text(const Allowance& allowance) {
  const auto side = [](double length, const char* direction, const std::string& limit) {
    if (std::isinf(length)) return fmt::format("any length {}", direction);
    return fmt::format("{:.4f} m {}", length, direction) +
           (limit.empty() ? "" : fmt::format(" ({})", limit));
  };
  return fmt::format("{} or {}", side(allowance.less, "shorter", allowance.less_limit),
                     side(allowance.more, "longer", allowance.more_limit));
}

/// An angle in radians and degrees.
std::string angle_text(double angle, int digits) {
  return fmt::format("{:.{}g} rad ({:.4g} deg)", angle, digits,
                     angle / boost::math::double_constants::degree);
}

std::string pin_allowance_text(const OptimumResult& result) {
  if (!result.pin_allowance) return "";
  const auto side = [](double angle, const char* direction, const std::string& limit) {
    if (std::isinf(angle)) return fmt::format("any angle {}", direction);
    return fmt::format("{} {}", angle_text(angle, 4), direction) +
           (limit.empty() ? "" : fmt::format(" ({})", limit));
  };
  const auto& [less, more, less_limit, more_limit] = *result.pin_allowance;
  return fmt::format("           pin: {} or {}\n", side(less, "less", less_limit),
                     side(more, "more", more_limit));
}

/// A text, or null if it is empty.
Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

/// Whether the job gives all lengths.
bool is_given(const Job& job) {
  const DesignSpace space = design_space(job.scene, job.lattice);
  return space.lower == space.upper;
}

/// What each limit is worth.
std::string limits_text(const OptimumResult& result, const Job& job) {
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
  return text;
}

/// Why the optimum is not the design with the largest value.
std::string unsafe_text(const OptimumResult& result, const Job& job) {
  if (!result.unsafe) return "";
  const auto& [design, value] = *result.unsafe;
  const double deviation = job.optimum.deviation;
  return fmt::format(
      "           the best design found that tolerates lengths off by up to {}:\n"
      "           the {} jumps or falls steeply, or a constraint jumps, next to {:.9g}{} at {}\n",
      deviation > 0 ? fmt::format("{} m", deviation) : "0.1 %", info(result.objective).name, value,
      after_number(unit_of(result)), to_text(design));
}

/// A field at the optimum, if it is known: "the_name 1.25 m".
std::string value_text(const OptimumResult& result, Field field, const char* name) {
  const auto found = std::ranges::find(result.values, field, &BuildValue::field);
  if (found == result.values.end()) return "";
  const double value = std::abs(found->value) < 1e-9 ? 0 : found->value;  // rounding errors
  if (field == Field::pin_angle) return fmt::format("{} {}", name, angle_text(value, 10));
  return fmt::format("{} {:.6g}{}", name, value, after_number(unit_text(info(field).units)));
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
  const DesignSpace space = design_space(job.scene, job.lattice);
  const std::array axes{&job.lattice.r1, &job.lattice.r3, &job.lattice.r2};
  std::vector<std::string> crossed;
  for (std::size_t d = 0; d < 3; ++d) {
    if (!*axes[d] || !(space.lower[d] < space.upper[d])) continue;
    const double length = lengths(result.design)[d], deviation = job.optimum.deviation;
    if (length - deviation < space.lower[d])
      crossed.push_back(fmt::format("{} < {:.9g} m", length_names[d], space.lower[d]));
    if (length + deviation > space.upper[d])
      crossed.push_back(fmt::format("{} > {:.9g} m", length_names[d], space.upper[d]));
  }
  return crossed;
}

std::string robustness_text(const OptimumResult& result, const Job& job) {
  if (!result.robustness) return "";
  const auto [worst, expected, unreleased] = *result.robustness;
  const std::string values =
      unreleased ? fmt::format("no worst value, {} has no release", to_text(*unreleased))
                 : fmt::format("worst {:.9g}, expected {:.9g}{}", worst, expected,
                               after_number(unit_of(result)));
  std::string text =
      fmt::format("deviation  lengths off by up to {} m: {}\n", job.optimum.deviation, values);
  if (const auto crossed = ends_crossed(result, job); !crossed.empty())
    text +=
        fmt::format("           some of them are beyond an axis: {}\n", fmt::join(crossed, ", "));
  return text;
}

/// How precisely to build.
std::string precision_text(const OptimumResult& result) {
  std::string text;
  for (const std::size_t d : {0u, 2u, 1u})  // r1, r2, r3
    text +=
        fmt::format("{:10} {}: {}; gradient {:+.4g}, curvature {:+.4g}\n",
                    text.empty() ? "1 % lost" : "", length_names[d],
                    allowance_text(result.allowances[d]), result.gradient[d], result.hessian[d][d]);
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

std::string maxima_text(const OptimumResult& result) {
  const auto& maxima = result.maxima;
  std::string text =
      fmt::format("maxima     {} found from {} start{}; {} led to the optimum\n", maxima.size(),
                  result.starts, result.starts == 1 ? "" : "s", maxima.front().starts);
  if (maxima.size() > 1)
    text += fmt::format("           the next best is {:.9g}{} at {}\n", maxima[1].value,
                        after_number(unit_of(result)), to_text(maxima[1].design));
  return text;
}

/// The least and the largest value of each length, the other two as in a design.
Json bounds(const DesignSpace& space, const Design<double>& design) {
  const std::array<double, 3> r = lengths(design);
  Json all;
  for (std::size_t d = 0; d < 3; ++d) {
    double upper = space.upper[d];
    if (d > 0 && space.longest_sum) upper = std::min(upper, *space.longest_sum - r[3 - d]);
    all.push_back({space.lower[d], upper});
  }
  return all;
}

}  // namespace

std::string to_text(const OptimumResult& result, const Job& job) {
  const std::string unit = after_number(unit_of(result));
  const Solver solver = solver_of("vern8", 1e-13, job.solver);
  std::string text =
      fmt::format("scene      {}\nsolver     {}\n", scene_text(job), solver_text(solver));
  text += fmt::format("optimum    {} {:.10g}{}, error {:.1g}\n", info(result.objective).name,
                      result.value, unit, result.error);
  text += unsafe_text(result, job);
  text += fmt::format("design     {}, released at {:.8g} s\n", to_text(result.design),
                      result.release_time);
  if (const auto faults = problems(result, job); !faults.empty())
    text += fmt::format("warning    {}\n", to_text(faults));
  text += build_text(result) + limits_text(result, job) + precision_text(result);
  text += robustness_text(result, job);
  text += maxima_text(result);
  text += fmt::format("designs    {}", result.designs);
  if (result.coarse_increment > 0)
    text +=
        fmt::format(", those of the coarse sweep with a spacing of {} m", result.coarse_increment);
  text += fmt::format("\nseconds    {:.2f}\n\n", result.seconds);
  return text + sensitivities_text(result);
}

std::string to_json(const OptimumResult& result, const Job& job) {
  Json json{{"objective", info(result.objective).name},
            {"value", result.value},
            {"error", result.error},
            {"r1", result.design.r1},
            {"r3", result.design.r3},
            {"r2", result.design.r2},
            {"release_time", result.release_time},
            {"converged", result.converged},
            {"unsafe", Json()},
            {"warnings", Json::array()},
            {"values", Json::object()},
            {"constraints", Json::array()},
            {"build_constraints", Json::array()},
            {"active", Json::array()},
            {"bounds", bounds(design_space(job.scene, job.lattice), result.design)},
            {"gradient", result.gradient},
            {"hessian", result.hessian},
            {"one_percent_loss", Json::array()},
            {"one_percent_limit", Json::array()},
            {"pin_angle_loss", Json()},
            {"pin_angle_limit", Json()},
            {"range_with_wind", Json()},
            {"sensitivity", Json::object()},
            {"sensitivity_of_optimum", Json::object()},
            {"worst", result.robustness ? Json(result.robustness->worst) : Json()},
            {"expected", result.robustness ? Json(result.robustness->expected) : Json()},
            {"maxima", Json::array()},
            {"starts", result.starts},
            {"starts_at_best", result.maxima.front().starts},
            {"coarse_increment", result.coarse_increment},
            {"designs", result.designs},
            {"seconds", result.seconds},
            {"units", Json::object()},
            {"constraint_units", Json::object()},
            {"version", version_text()},
            {"job", to_text(job)}};
  if (const auto& unsafe = result.unsafe)
    json["unsafe"] = {{"value", unsafe->value},
                      {"r1", unsafe->design.r1},
                      {"r3", unsafe->design.r3},
                      {"r2", unsafe->design.r2}};
  for (const BuildProblem& problem : problems(result, job))
    json["warnings"].push_back(problem.text);
  for (const auto& [field, value] : result.values) {
    json["values"][info(field).name] = value;
    json["units"][info(field).name] = info(field).units;
  }
  json["units"][info(result.objective).name] = info(result.objective).units;
  for (const Constraint& c : constraints_of(job)) json["constraints"].push_back(to_text(c));
  const auto searched = searched_job(job).optimum.constraints;
  for (const Field field : fields_of(searched)) json["units"][info(field).name] = info(field).units;
  for (const Constraint& c : searched)
    json["constraint_units"][c.expression.text] = c.expression.unit;
  for (std::size_t i = job.optimum.constraints.size(); i < searched.size(); ++i)
    json["build_constraints"].push_back(to_text(searched[i]));
  for (const ActiveLimit& limit : result.active)
    json["active"].push_back({{"constraint", limit.constraint}, {"multiplier", limit.multiplier}});
  for (const Allowance& allowance : result.allowances) {
    json["one_percent_loss"].push_back({allowance.less, allowance.more});
    json["one_percent_limit"].push_back(
        {text_or_null(allowance.less_limit), text_or_null(allowance.more_limit)});
  }
  if (const auto& pin = result.pin_allowance) {
    json["pin_angle_loss"] = {pin->less, pin->more};
    json["pin_angle_limit"] = {text_or_null(pin->less_limit), text_or_null(pin->more_limit)};
  }
  if (const auto& wind = result.range_with_wind)
    json["range_with_wind"] = {{"less", wind->less}, {"more", wind->more}};
  for (const auto& [key, sensitivity] : result.sensitivities) {
    json["sensitivity"][key] = sensitivity.at_design;
    json["sensitivity_of_optimum"][key] = sensitivity.of_optimum;
  }
  for (const LocalMaximum& m : result.maxima)
    json["maxima"].push_back(
        {{"r1", m.design.r1}, {"r3", m.design.r3}, {"r2", m.design.r2}, {"value", m.value}});
  return json.dump(2);
}

}  // namespace trebsweep
