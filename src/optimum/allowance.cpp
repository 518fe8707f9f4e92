#include "trebsweep/optimum/allowance.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "trebsweep/optimum/field_values.hpp"

namespace trebsweep {
namespace {

/// By how much a length or an angle may be off to one side, and what ends it: empty for the loss of
/// 1 %.
struct End {
  double distance;
  std::string limit;
};

/// The values_at() what is off by some distances, a column for each.
using ValuesOff = std::function<Eigen::MatrixXd(const std::vector<double>& distances)>;

/// The largest part of a parameter, and the largest angle (rad), by which it is said to be off.
constexpr double largest_part = 0.5, largest_angle = 1;

/// The end of a parameter's interval() to one side, or none if that is far away.
End first_bound(const DesignProblem& problem, const std::vector<Limit>& all,
                const Parameters& parameters, Eigen::Index parameter, double sign) {
  const double value = parameters(parameter);
  const bool is_angle = problem.space.units[static_cast<std::size_t>(parameter)] == "rad";
  const IntervalEnd end = interval(problem, parameters, parameter)[sign > 0];
  const double far = is_angle     ? largest_angle
                     : value != 0 ? largest_part * std::abs(value)
                                  : scale_of(problem.space, parameter);
  const double distance = sign * (end.value - value);
  return distance < far ? End{std::max(0.0, distance), all[end.limit].text} : End{far, ""};
}

/// What a design has passed, by its column of values_at(): a limit, or the least objective.
std::optional<std::string> passed(const Eigen::VectorXd& values, const std::vector<Limit>& all,
                                  double least) {
  if (values.hasNaN()) return "no release";
  for (Eigen::Index i = 1; i < values.size(); ++i)
    if (values(i) > feasibility_tolerance) return all[static_cast<std::size_t>(i) - 1].text;
  if (values(0) < least) return "";
  return std::nullopt;
}

/// The end of an allowance to one side, up to a bound, where the objective is `least` or a limit is
/// reached.
End end_of(const ValuesOff& values_off, const std::vector<Limit>& all, const End& bound,
           double sign, double least, double precision) {
  constexpr int parts = 64;  // of the interval, per round
  double low = 0, high = bound.distance;
  std::optional<std::string> end;
  while (high - low > precision) {
    std::vector<double> distances;
    const double part = (high - low) / parts;
    for (int i = 1; i < parts; ++i) distances.push_back(sign * (low + part * i));
    const Eigen::MatrixXd values = values_off(distances);
    int i = 0;
    std::optional<std::string> what;
    while (i < parts - 1 && !(what = passed(values.col(i), all, least))) ++i;
    if (what) {
      end = what;
      high = low + part * (i + 1);
    }
    low += part * i;
  }
  if (end) return {low, *end};
  if (bound.limit.empty()) return {std::numeric_limits<double>::infinity(), ""};
  return bound;
}

/// The objective when 1 % of its magnitude is lost.
double least_objective(const DesignProblem& problem, const Parameters& parameters, double value) {
  return value - 0.01 * magnitude_at(problem, parameters);
}

}  // namespace

std::vector<Allowance> allowances(const DesignProblem& problem, const Parameters& parameters,
                                  std::uint64_t& integrated) {
  ++integrated;
  const double value = values_at(problem, parameters)(0, 0);
  const double least = least_objective(problem, parameters, value);
  const std::vector<Limit> all = limits(problem);
  std::vector<Allowance> found;
  for (Eigen::Index d = 0; d < parameters.size(); ++d) {
    const auto values_off = [&](const std::vector<double>& distances) {
      Eigen::MatrixXd off = parameters.replicate(1, std::ssize(distances));
      off.row(d) += Eigen::RowVectorXd::Map(distances.data(), off.cols());
      integrated += distances.size();
      return values_at(problem, off);
    };
    const double size = std::max(std::abs(parameters(d)), 0.01 * scale_of(problem.space, d));
    const auto end = [&](double sign) {
      const End bound = first_bound(problem, all, parameters, d, sign);
      return end_of(values_off, all, bound, sign, least, 1e-7 * size);
    };
    const End less = end(-1), more = end(1);
    found.push_back({less.distance, more.distance, less.limit, more.limit});
  }
  return found;
}

std::optional<Allowance> pin_allowance(const DesignProblem& problem, const Parameters& parameters,
                                       std::uint64_t& integrated) {
  constexpr double same = 1e-6, precision = 1e-6;  // relative; rad
  constexpr Field field = Field::pin_angle;
  const double angle = field_values(problem.machine, Accuracy::high, parameters, {&field, 1})(0);
  const double value = values_at(problem, parameters)(0, 0);
  DesignProblem pinned = problem;
  pinned.machine = at(problem.machine, parameters);
  pinned.machine.variables.clear();
  pinned.machine.solver.release = Release::pin;
  const auto values_off = [&](const std::vector<double>& distances) {
    Eigen::MatrixXd values(1 + problem.constraints.size(), distances.size());
    integrated += distances.size();
    for (std::size_t i = 0; i < distances.size(); ++i) {
      pinned.machine.solver.pin_angle = angle + distances[i];
      values.col(static_cast<Eigen::Index>(i)) = values_at(pinned, parameters.head(length_count));
    }
    return values;
  };
  if (!(std::abs(angle) < std::numbers::pi) ||
      !(std::abs(values_off({0.0})(0, 0) - value) <= same * magnitude_at(problem, parameters)))
    return std::nullopt;
  const std::vector<Limit> all = limits(problem);
  const auto end = [&](double sign) {
    const End bound{std::min(largest_angle, std::numbers::pi - sign * angle), ""};
    return end_of(values_off, all, bound, sign, least_objective(problem, parameters, value),
                  precision);
  };
  const End less = end(-1), more = end(1);
  return Allowance{less.distance, more.distance, less.limit, more.limit};
}

}  // namespace trebsweep
