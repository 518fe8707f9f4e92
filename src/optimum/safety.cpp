#include "trebsweep/optimum/safety.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Lengths = std::array<double, 3>;

constexpr double default_deviation = 1e-3;  // relative
constexpr double jump = 1e-3;               // relative to the value, or a constraint's scale

/// The points of a cube of 3^3 around the origin, without it.
std::vector<Lengths> directions() {
  std::vector<Lengths> all;
  for (int k = 0; k < 27; ++k)
    if (k != 13)
      all.push_back({static_cast<double>(k / 9 - 1), static_cast<double>(k / 3 % 3 - 1),
                     static_cast<double>(k % 3 - 1)});
  return all;
}

Lengths scaled(const Lengths& a, const Lengths& by) {
  return {a[0] * by[0], a[1] * by[1], a[2] * by[2]};
}

/// The objective and the violations of the constraints, a column per design.
MatrixXd counted_values(const DesignProblem& problem, const std::vector<Design<double>>& designs,
                        std::uint64_t& integrated) {
  integrated += designs.size();
  MatrixXd values = values_at(problem, designs);
  auto constraints = values.bottomRows(values.rows() - 1);
  constraints = constraints.unaryExpr([](double v) { return v < 0 ? 0 : v; });  // NaN stays
  return values;
}

/// Whether the values of a function differ by a jump, or one of them does not exist. A constraint,
/// any function but the first, jumps only where it becomes violated.
bool differ(Index function, double a, double b) {
  return function == 0 ? !(std::abs(a - b) <= jump * std::abs(a)) : !(b - a <= jump);
}

/// A part of a line on which a function changes by more than a jump.
struct Segment {
  Index function;
  Lengths towards;
  double low, high;  // fractions
  double at_low, at_high;
};

/// Whether bisection ends at a jump, rather than at a steep slope, on any of the segments.
bool any_jumps(const DesignProblem& problem, const Design<double>& design,
               std::vector<Segment> segments, std::uint64_t& integrated) {
  constexpr int rounds = 30;
  for (int round = 0; round < rounds && !segments.empty(); ++round) {
    std::vector<Design<double>> middles;
    for (const Segment& s : segments)
      middles.push_back(moved(design, s.towards, (s.low + s.high) / 2));
    const MatrixXd values = counted_values(problem, middles, integrated);
    for (std::size_t i = 0; i < segments.size(); ++i) {
      Segment& s = segments[i];
      const double middle = (s.low + s.high) / 2;
      const double value = values(s.function, static_cast<Index>(i));
      // A missing value is beyond any difference.
      const bool below =
          std::isnan(value) ||
          (!std::isnan(s.at_high) && std::abs(value - s.at_low) > std::abs(s.at_high - value));
      (below ? s.high : s.low) = middle;
      (below ? s.at_high : s.at_low) = value;
    }
    std::erase_if(segments,
                  [](const Segment& s) { return !differ(s.function, s.at_low, s.at_high); });
  }
  return !segments.empty();
}

/// A design with its objective, which satisfies the constraints.
struct Candidate {
  Design<double> design;
  double objective;
};

bool is_inside(const DesignProblem& problem, const Design<double>& design) {
  const Lengths r = lengths(design);
  for (std::size_t d = 0; d < 3; ++d)
    if (!(r[d] >= problem.space.lower[d] && r[d] <= problem.space.upper[d])) return false;
  return !has_sum(problem) || r[1] + r[2] <= *problem.space.longest_sum;
}

/// Those of some designs that satisfy the constraints, best first.
std::vector<Candidate> candidates(const DesignProblem& problem, std::vector<Design<double>> designs,
                                  std::uint64_t& integrated) {
  std::erase_if(designs, [&](const auto& design) { return !is_inside(problem, design); });
  std::vector<Candidate> found;
  if (designs.empty()) return found;
  integrated += designs.size();
  const MatrixXd values = values_at(problem, designs);
  for (Index i = 0; i < values.cols(); ++i) {
    const auto column = values.col(i);
    const bool satisfied =
        column.size() == 1 || column.tail(column.size() - 1).maxCoeff() <= feasibility_tolerance;
    if (column.allFinite() && satisfied)
      found.push_back({designs[static_cast<std::size_t>(i)], column(0)});
  }
  std::ranges::stable_sort(found, std::greater{}, &Candidate::objective);
  return found;
}

/// The best of some designs that is safe and better than a value.
std::optional<Candidate> best_safe(const DesignProblem& problem,
                                   const std::vector<Design<double>>& designs, double better_than,
                                   double deviation, std::uint64_t& integrated) {
  for (const Candidate& candidate : candidates(problem, designs, integrated)) {
    if (!(candidate.objective > better_than)) break;
    if (is_safe(problem, candidate.design, deviation, integrated)) return candidate;
  }
  return std::nullopt;
}

/// The designs around a design, at a multiple of the tolerated deviations; fixed lengths stay.
std::vector<Design<double>> around(const DesignProblem& problem, const Design<double>& design,
                                   double deviation, double multiple) {
  Lengths reach{};
  for (const std::size_t d : problem.variables) reach[d] = tolerated(design, deviation)[d];
  std::vector<Design<double>> designs;
  for (const Lengths& direction : directions()) {
    const Design<double> other = moved(design, scaled(direction, reach), multiple);
    if (std::ranges::find(designs, other) == designs.end() && !(other == design))
      designs.push_back(other);
  }
  return designs;
}

}  // namespace

std::array<double, 3> tolerated(const Design<double>& design, double deviation) {
  if (deviation > 0) return {deviation, deviation, deviation};
  return scaled(lengths(design), {default_deviation, default_deviation, default_deviation});
}

bool is_safe(const DesignProblem& problem, const Design<double>& design, double deviation,
             std::uint64_t& integrated) {
  const Lengths reach = tolerated(design, deviation);
  std::vector<Design<double>> designs{design};
  for (std::size_t d = 0; d < 3; ++d)
    for (const double sign : {-1.0, 1.0}) {
      Lengths by{};
      by[d] = sign * default_deviation / 2 * lengths(design)[d];
      designs.push_back(moved(design, by));
    }
  const auto steep = static_cast<Index>(designs.size());
  std::vector<Lengths> lines;
  for (const double part : {0.5, 1.0})
    for (const Lengths& direction : directions())
      lines.push_back(scaled(scaled(direction, reach), {part, part, part}));
  for (const Lengths& line : lines) designs.push_back(moved(design, line));
  const MatrixXd values = counted_values(problem, designs, integrated);

  constexpr double largest_loss = 0.02;
  const double value = values(0, 0), least = value - largest_loss * std::abs(value);
  for (Index i = 0; i < steep; ++i)
    if (!(values(0, i) > least)) return false;
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (Index f = 0; f < values.rows(); ++f) {
      const double here = values(f, 0), there = values(f, steep + static_cast<Index>(i));
      if (std::isnan(there)) return false;
      if (differ(f, here, there)) segments.push_back({f, lines[i], 0, 1, here, there});
    }
  return !any_jumps(problem, design, segments, integrated);
}

std::optional<Design<double>> safe_design_near(const DesignProblem& problem,
                                               const Design<double>& design, double deviation,
                                               std::uint64_t& integrated) {
  std::optional<Candidate> best;
  for (const double multiple : {1.1, 2.0, 4.0, 8.0, 16.0, 40.0, 80.0}) {
    best = best_safe(problem, around(problem, design, deviation, multiple), -HUGE_VAL, deviation,
                     integrated);
    if (best) break;
  }
  if (!best) return std::nullopt;
  for (double multiple = 2; multiple > 0.02;) {
    const auto next = best_safe(problem, around(problem, best->design, deviation, multiple),
                                best->objective, deviation, integrated);
    if (next)
      best = next;
    else
      multiple /= 2;
  }
  return best->design;
}

}  // namespace trebsweep
