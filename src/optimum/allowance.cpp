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

/// The first bound that a length reaches as it becomes shorter or longer, or no bound after half of
/// it.
End first_bound(const DesignProblem& problem, const std::vector<Limit>& all,
                const Design<double>& design, std::size_t length, double sign) {
  const std::array<double, 3> r = lengths(design);
  const DesignSpace& space = problem.space;
  End first{0.5 * r[length], ""};
  const auto add = [&](double distance, std::size_t limit) {
    if (distance < first.distance) first = {std::max(distance, 0.0), all[limit].text};
  };
  const std::size_t sum = problem.constraints.size();  // the limit r2 + r3 <= h0, if there is one
  if (has_sum(problem) && length > 0 && sign > 0) add(*space.longest_sum - r[1] - r[2], sum);
  const auto& variables = problem.variables;
  const auto variable = std::ranges::find(variables, length);
  if (variable == variables.end()) return first;
  const std::size_t lower =
      sum + (has_sum(problem) ? 1 : 0) + static_cast<std::size_t>(variable - variables.begin());
  if (sign < 0)
    add(r[length] - space.lower[length], lower);
  else
    add(space.upper[length] - r[length], lower + variables.size());
  return first;
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

/// The objective when 1 % of it is lost.
double least_objective(double value) { return value - 0.01 * std::abs(value); }

}  // namespace

std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated) {
  ++integrated;
  const double least = least_objective(values_at(problem, {&design, 1})(0, 0));
  const std::vector<Limit> all = limits(problem);
  std::array<Allowance, 3> found;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto values_off = [&](const std::vector<double>& distances) {
      std::vector<Design<double>> designs;
      for (const double distance : distances) {
        std::array<double, 3> by{};
        by[d] = distance;
        designs.push_back(moved(design, by));
      }
      integrated += designs.size();
      return values_at(problem, designs);
    };
    const auto end = [&](double sign) {
      const End bound = first_bound(problem, all, design, d, sign);
      return end_of(values_off, all, bound, sign, least, 1e-7 * lengths(design)[d]);
    };
    const End less = end(-1), more = end(1);
    found[d] = {less.distance, more.distance, less.limit, more.limit};
  }
  return found;
}

std::optional<Allowance> pin_allowance(const DesignProblem& problem, const Design<double>& design,
                                       std::uint64_t& integrated) {
  constexpr double same = 1e-6, precision = 1e-6;  // relative; rad
  constexpr Field field = Field::pin_angle;
  const double angle =
      field_values(problem.scene, problem.solver, Accuracy::high, {&design, 1}, {&field, 1})(0);
  const double value = values_at(problem, {&design, 1})(0, 0);
  DesignProblem pinned = problem;
  pinned.solver.release = Release::pin;
  const auto values_off = [&](const std::vector<double>& distances) {
    Eigen::MatrixXd values(1 + problem.constraints.size(), distances.size());
    integrated += distances.size();
    for (std::size_t i = 0; i < distances.size(); ++i) {
      pinned.solver.pin_angle = angle + distances[i];
      values.col(static_cast<Eigen::Index>(i)) = values_at(pinned, {&design, 1});
    }
    return values;
  };
  if (!(std::abs(angle) < std::numbers::pi) ||
      !(std::abs(values_off({0.0})(0, 0) - value) <= same * std::abs(value)))
    return std::nullopt;
  const std::vector<Limit> all = limits(problem);
  const auto end = [&](double sign) {
    const End bound{std::min(1.0, std::numbers::pi - sign * angle), ""};
    return end_of(values_off, all, bound, sign, least_objective(value), precision);
  };
  const End less = end(-1), more = end(1);
  return Allowance{less.distance, more.distance, less.limit, more.limit};
}

}  // namespace trebsweep
