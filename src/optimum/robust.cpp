#include "trebsweep/optimum/robust.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// The deviation within the box at which a row of values_at() is smallest (sign 1) or largest (-1),
/// and its value there; NaN at one that has none.
struct Extreme {
  std::array<double, 3> deviation;
  double value;
};

Extreme extreme_in_box(const DesignProblem& problem, const Design<double>& centre, double deviation,
                       Index row, double sign, std::uint64_t& integrated) {
  const std::array<double, 3> scale = lengths(centre);
  const auto deviation_of = [&](const VectorXd& x) {
    return std::array{x(0) * scale[0], x(1) * scale[1], x(2) * scale[2]};
  };
  const auto functions = [&](const MatrixXd& points) {
    std::vector<Design<double>> designs;
    for (const auto& x : points.colwise()) designs.push_back(moved(centre, deviation_of(x)));
    integrated += designs.size();
    return MatrixXd(-sign * values_at(problem, designs).row(row));
  };
  const VectorXd reach = deviation * Eigen::Map<const Eigen::Array3d>(scale.data()).inverse();
  const NonlinearProgram program{functions, 1, 0, -reach, reach};

  constexpr Index width = 9;
  MatrixXd lattice(3, width * width * width);
  for (Index p = 0; p < lattice.cols(); ++p)
    for (Index d = 0, rest = p; d < 3; ++d, rest /= width)
      lattice(d, p) = reach(d) * (2.0 * static_cast<double>(rest % width) / (width - 1) - 1);
  const MatrixXd values = functions(lattice);
  for (Index p = 0; p < values.cols(); ++p)
    if (std::isnan(values(p))) return {deviation_of(lattice.col(p)), no_value};
  Index start = 0;
  values.row(0).maxCoeff(&start);
  const Point worst = search(program, lattice.col(start)).point;
  return {deviation_of(worst.x), -sign * worst.objective};
}

std::vector<Deviation> vertices(double deviation, double weight) {
  std::vector<Deviation> all;
  for (const double d1 : {-deviation, deviation})
    for (const double d3 : {-deviation, deviation})
      for (const double d2 : {-deviation, deviation}) all.push_back({{d1, d3, d2}, weight, true});
  return all;
}

/// The nodes of the mean over the box.
std::vector<Deviation> quadrature(double deviation) {
  using Gauss = boost::math::quadrature::gauss<double, 7>;
  std::vector<std::array<double, 2>>
      nodes;  // and weights, of the mean over [-deviation, deviation]
  for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i)
    for (const double sign : {-1.0, 1.0})
      if (Gauss::abscissa()[i] != 0 || sign > 0)
        nodes.push_back({sign * deviation * Gauss::abscissa()[i], Gauss::weights()[i] / 2});
  std::vector<Deviation> all;
  for (const auto& [d1, w1] : nodes)
    for (const auto& [d3, w3] : nodes)
      for (const auto& [d2, w2] : nodes) all.push_back({{d1, d3, d2}, w1 * w3 * w2, false});
  return all;
}

/// Adds a deviation, instead of one that is close to it and of the same kind, unless that is one of
/// the `permanent` first ones.
void add_or_replace(std::vector<Deviation>& deviations, std::size_t permanent, double close,
                    const Deviation& added) {
  const auto is_close = [&](const Deviation& known) {
    double distance = 0;
    for (std::size_t d = 0; d < 3; ++d)
      distance = std::max(distance, std::abs(known.lengths[d] - added.lengths[d]));
    return distance < close && known.constrained == added.constrained;
  };
  const auto first = deviations.begin() + static_cast<std::ptrdiff_t>(permanent);
  const auto known = std::find_if(first, deviations.end(), is_close);
  if (known != deviations.end())
    *known = added;
  else
    deviations.push_back(added);
}

/// The multipliers of the constraints of several deviations, added up for each constraint.
VectorXd summed(const VectorXd& multipliers, Index fields, Index deviations) {
  const Index rest = multipliers.size() - fields * deviations;
  VectorXd sums = VectorXd::Zero(fields + rest);
  for (Index d = 0; d < deviations; ++d)
    sums.head(fields) += multipliers.segment(d * fields, fields);
  sums.tail(rest) = multipliers.tail(rest);
  return sums;
}

}  // namespace

Robustness robustness(const DesignProblem& problem, const Design<double>& design, double deviation,
                      std::uint64_t& integrated) {
  const double scale = problem.scales.front();
  const auto [where, worst] = extreme_in_box(problem, design, deviation, 0, 1, integrated);
  if (std::isnan(worst)) return {no_value, no_value, moved(design, where)};
  std::vector<Design<double>> designs;
  const std::vector<Deviation> nodes = quadrature(deviation);
  for (const Deviation& node : nodes) designs.push_back(moved(design, node.lengths));
  integrated += designs.size();
  const MatrixXd values = values_at(problem, designs);
  double expected = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    expected += nodes[i].weight * values(0, static_cast<Index>(i));
  return {worst * scale, expected * scale, std::nullopt};
}

DesignSpace robust_space(const Scene& scene, DesignSpace space, double deviation) {
  constexpr double inside = 1 + 1e-10;  // the bounds are open
  const std::array possible{arm_bounds(scene).low, 0.0, 0.0};
  for (std::size_t d = 0; d < 3; ++d)
    if (space.lower[d] < space.upper[d])
      space.lower[d] = std::max(space.lower[d], (possible[d] + deviation) * inside);
  return space;
}

KktPoint robust_search(const DesignProblem& problem, const Design<double>& start, Robust robust,
                       double deviation, std::uint64_t& integrated) {
  const bool mean = robust == Robust::expected;
  const Aggregate aggregate = mean ? Aggregate::mean : Aggregate::worst;
  std::vector<Deviation> deviations = vertices(deviation, mean ? 0 : 1);
  if (mean) {
    const std::vector<Deviation> nodes = quadrature(deviation);
    deviations.insert(deviations.end(), nodes.begin(), nodes.end());
  }
  const std::size_t permanent = deviations.size();
  const auto fields = static_cast<Index>(problem.constraints.size());
  constexpr int rounds = 20;
  constexpr double precision = 1e-10;
  KktPoint found;
  VectorXd x = to_variables(problem, start);
  for (int round = 0; round < rounds; ++round) {
    found = search(program_of(problem, deviations, aggregate, integrated), x);
    const auto constrained = std::ranges::count_if(deviations, &Deviation::constrained);
    found.multipliers = summed(found.multipliers, fields, constrained);
    if (!is_feasible(found.point)) return found;
    x = found.point.x;
    bool exact = true;
    for (Index row = mean ? 1 : 0; row <= fields; ++row) {
      const bool objective = row == 0;
      const Extreme extreme = extreme_in_box(problem, to_design(problem, x), deviation, row,
                                             objective ? 1 : -1, integrated);
      if (std::isnan(extreme.value)) {
        found.point.violation = std::numeric_limits<double>::infinity();
        return found;
      }
      if (objective ? extreme.value >= found.point.objective - precision
                    : extreme.value <= precision)
        continue;
      exact = false;
      add_or_replace(deviations, permanent, deviation / 10,
                     {extreme.deviation, objective ? 1.0 : 0.0, !objective});
    }
    if (exact) return found;
  }
  found.converged = false;
  return found;
}

}  // namespace trebsweep
