#include "trebsweep/optimum/pareto.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/base/text_table.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/report.hpp"

namespace trebsweep {
namespace {

using Json = nlohmann::ordered_json;

/// The job with another objective, checked as that of a job file.
Job with_objective(const Job& job, const std::string& objective) {
  return parse_job(to_text(job), "", {{"optimum.objective", objective}});
}

/// The value of an expression at parameters.
double value_at(const Job& job, const Expression& expression, const Parameters& parameters) {
  const MachineFamily machine = family_of(job);
  const Eigen::MatrixXd values =
      field_values(machine, Accuracy::high, parameters, expression.fields);
  double value = 0;
  for_each_design(
      machine, parameters, expression.fields, values,
      [&](Eigen::Index, const Operands& operands) { value = expression.value(operands); });
  return value;
}

/// The parameters of a result of rank 0, on all ranks. Collective.
Parameters on_all_ranks(const std::optional<OptimumResult>& result, const Job& job, MPI_Comm comm) {
  Parameters parameters = Parameters::Zero(length_count + std::ssize(job.optimum.variables));
  if (result) parameters = result->parameters;
  mpi::merge(std::span(parameters.data(), static_cast<std::size_t>(parameters.size())), comm);
  return parameters;
}

/// The multiplier of a constraint at an optimum; NaN if it is not known.
double multiplier_of(const OptimumResult& result, const Constraint& constraint) {
  const auto found =
      std::ranges::find(result.active, to_text(constraint), &ActiveLimit::constraint);
  return found == result.active.end() ? std::numeric_limits<double>::quiet_NaN()
                                      : found->multiplier;
}

/// A number for a table; "-" for NaN.
std::string cell(double x, int digits) {
  return std::isnan(x) ? "-" : fmt::format("{:.{}g}", x, digits);
}

}  // namespace

std::vector<ParetoPoint> pareto_front(const Job& given, const ParetoSpec& spec,
                                      const OptimumOptions& given_options, MPI_Comm comm) {
  const Job job = with_objective(given, spec.first), other = with_objective(given, spec.second);
  const Expression& second = other.optimum.objective;
  OptimumOptions options = given_options;
  std::vector<ParetoPoint> front;
  const auto add = [&](const std::optional<OptimumResult>& result, const Parameters& parameters,
                       double multiplier) {
    if (result)
      front.push_back({*result, value_at(job, job.optimum.objective, parameters),
                       value_at(job, second, parameters), multiplier});
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto begin = find_optimum(job, options, comm), end = find_optimum(other, options, comm);
  const Parameters first_end = on_all_ranks(begin, job, comm),
                   last_end = on_all_ranks(end, job, comm);
  const double low = value_at(job, second, first_end), high = value_at(job, second, last_end);
  add(begin, first_end, nan);
  Parameters last = first_end;
  for (std::size_t i = 1; i + 1 < spec.points && low < high; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(spec.points - 1);
    Job limited = job;
    const Constraint limit{second, false, low + part * (high - low)};
    limited.optimum.constraints.push_back(limit);
    options.starts = {last, last_end};
    try {
      const auto result = find_optimum(limited, options, comm);
      last = on_all_ranks(result, job, comm);
      add(result, last, result ? multiplier_of(*result, limit) : nan);
    } catch (const NoOptimum&) {
      // No design of this level is safe to build.
    }
  }
  if (low < high) add(end, last_end, nan);
  return front;
}

std::string to_text(const std::vector<ParetoPoint>& front, const ParetoSpec& spec, const Job& job,
                    UnitSystem units) {
  const DesignSpace space = design_space(job);
  std::vector<TextColumn> columns;
  const auto add = [&](const std::string& name, const std::string& unit, auto value) {
    TextColumn column{{name, unit}};
    for (const ParetoPoint& point : front) column.cells.push_back(value(point));
    columns.push_back(column);
  };
  const ShownUnit first = shown_unit(to_expression(spec.first).value().unit, units);
  const ShownUnit second = shown_unit(to_expression(spec.second).value().unit, units);
  add(spec.first, first.name,
      [&](const ParetoPoint& p) { return cell(p.first / first.factor, 8); });
  add(spec.second, second.name,
      [&](const ParetoPoint& p) { return cell(p.second / second.factor, 8); });
  add("multiplier",
      second.name.empty() ? first.name : fmt::format("{} per {}", first.name, second.name),
      [&](const ParetoPoint& p) { return cell(p.multiplier * second.factor / first.factor, 5); });
  std::vector<std::size_t> order{0, 2, 1};  // r1, r2, r3
  for (std::size_t d = order.size(); d < space.names.size(); ++d) order.push_back(d);
  for (const std::size_t d : order) {
    const ShownUnit unit = shown_unit(space.units[d], units);
    add(space.names[d], unit.name, [&](const ParetoPoint& p) {
      return cell(p.result.parameters(static_cast<Eigen::Index>(d)) / unit.factor, 7);
    });
  }
  std::string text;
  for (const std::string& line : aligned(columns)) text += line + "\n";
  return text;
}

std::string to_json(const std::vector<ParetoPoint>& front, const ParetoSpec& spec, const Job& job) {
  const DesignSpace space = design_space(job);
  Json json{
      {"objectives", {spec.first, spec.second}},
      {"units", {to_expression(spec.first).value().unit, to_expression(spec.second).value().unit}},
      {"points", Json::array()},
      {"version", version_text()},
      {"job", to_text(job)}};
  for (const ParetoPoint& point : front) {
    Json& one = json["points"].emplace_back();
    one["values"] = {point.first, point.second};
    one["multiplier"] = point.multiplier;
    for (std::size_t d = 0; d < space.names.size(); ++d)
      one[space.names[d]] = point.result.parameters(static_cast<Eigen::Index>(d));
    one["active"] = Json::array();
    for (const ActiveLimit& limit : point.result.active) one["active"].push_back(limit.constraint);
    one["converged"] = point.result.converged;
    one["safe"] = !point.result.unsafe;
    one["warnings"] = warnings(point.result, found_job(point.result, job));
  }
  return json.dump(2);
}

}  // namespace trebsweep
