#include "trebsweep/optimum/allowance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace trebsweep {
namespace {

/// By how much a length may be off to one side, and what ends it: empty for the loss of 1 %.
struct End {
  double length;  ///< m
  std::string limit;
};

/// The first bound that a length reaches as it becomes shorter or longer, or no bound after half of
/// it.
End first_bound(const DesignProblem& problem, const std::vector<Limit>& all,
                const Design<double>& design, std::size_t length, double sign) {
  const std::array<double, 3> r = lengths(design);
  const DesignSpace& space = problem.space;
  End first{0.5 * r[length], ""};
  const auto add = [&](double distance, std::size_t limit) {
    if (distance < first.length) first = {std::max(distance, 0.0), all[limit].text};
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

/// The end of a length's allowance, where the objective is `least` or a limit is reached.
End end_of(const DesignProblem& problem, const std::vector<Limit>& all,
           const Design<double>& design, std::size_t length, double sign, double least,
           std::uint64_t& integrated) {
  constexpr int parts = 64;           // of the interval, per round
  constexpr double precision = 1e-7;  // relative to the length
  const End bound = first_bound(problem, all, design, length, sign);
  const double size = lengths(design)[length];
  double low = 0, high = bound.length;
  std::optional<std::string> end;
  while (high - low > precision * size) {
    std::vector<Design<double>> designs;
    const double part = (high - low) / parts;
    for (int i = 1; i < parts; ++i) {
      std::array<double, 3> by{};
      by[length] = sign * (low + part * i);
      designs.push_back(moved(design, by));
    }
    integrated += designs.size();
    const Eigen::MatrixXd values = values_at(problem, designs);
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

}  // namespace

std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated) {
  ++integrated;
  const double value = values_at(problem, {&design, 1})(0, 0);
  const double least = value - 0.01 * std::abs(value);
  const std::vector<Limit> all = limits(problem);
  std::array<Allowance, 3> found;
  for (std::size_t d = 0; d < 3; ++d) {
    const End shorter = end_of(problem, all, design, d, -1, least, integrated);
    const End longer = end_of(problem, all, design, d, 1, least, integrated);
    found[d] = {shorter.length, longer.length, shorter.limit, longer.limit};
  }
  return found;
}

}  // namespace trebsweep
