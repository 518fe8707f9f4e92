#include "trebsweep/optimum/json_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "trebsweep/base/version.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/report.hpp"

namespace trebsweep {
namespace {

using Json = nlohmann::ordered_json;

/// A text, or null if it is empty.
Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

std::vector<double> to_vector(const Eigen::VectorXd& values) {
  return {values.begin(), values.end()};
}

/// Parameters by their names.
Json named(const Parameters& parameters, const DesignSpace& space) {
  Json json;
  for (std::size_t d = 0; d < space.names.size(); ++d)
    json[space.names[d]] = parameters(static_cast<Eigen::Index>(d));
  return json;
}

}  // namespace

std::string to_json(const OptimumResult& result, const Job& given_job) {
  const Job job = found_job(result, given_job);
  const DesignSpace space = design_space(job);
  const ShownObjective objective = shown(result.objective);
  Json json{{"objective", result.objective.text},
            {"sought", fmt::format("{} {}", objective.extreme, objective.text)},
            {"value", result.value},
            {"error", result.error},
            {"r1", result.parameters(0)},
            {"r3", result.parameters(1)},
            {"r2", result.parameters(2)},
            {"variables", Json::object()},
            {"release_time", result.release_time},
            {"converged", result.converged},
            {"unsafe", Json()},
            {"warnings", Json::array()},
            {"values", Json::object()},
            {"constraints", Json::array()},
            {"build_constraints", Json::array()},
            {"active", Json::array()},
            {"bounds", result.bounds},
            {"gradient", to_vector(result.gradient)},
            {"hessian", Json::array()},
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
    (json["unsafe"] = named(unsafe->parameters, space))["value"] = unsafe->value;
  for (Eigen::Index d = length_count; d < space.size(); ++d) {
    const auto i = static_cast<std::size_t>(d);
    json["variables"][space.names[i]] = result.parameters(d);
    json["units"][space.names[i]] = space.units[i];
  }
  for (const auto& row : result.hessian.rowwise()) json["hessian"].push_back(to_vector(row));
  for (const std::string& warning : warnings(result, job)) json["warnings"].push_back(warning);
  for (const auto& [field, value] : result.values) {
    json["values"][info(field).name] = value;
    json["units"][info(field).name] = info(field).units;
  }
  json["units"][result.objective.text] = result.objective.unit;
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
    (json["maxima"].emplace_back() = named(m.parameters, space))["value"] = m.value;
  return json.dump(2);
}

}  // namespace trebsweep
