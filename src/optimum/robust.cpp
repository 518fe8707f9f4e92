#include "trebsweep/optimum/robust.hpp"

#include <algorithm>
#include <array>
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

/// The parameters that deviate: those in metres.
std::vector<Index> lengths_of(const DesignSpace& space) {
  std::vector<Index> lengths;
  for (Index d = 0; d < space.size(); ++d)
    if (space.units[static_cast<std::size_t>(d)] == "m") lengths.push_back(d);
  return lengths;
}

/// Points of a box with a number of dimensions, a column each: all combinations of some values.
MatrixXd combinations(const std::vector<double>& values, Index dimensions) {
  const Index width = std::ssize(values);
  MatrixXd points(dimensions, std::lround(std::pow(width, dimensions)));
  for (Index p = 0; p < points.cols(); ++p)
    for (Index d = dimensions - 1, rest = p; d >= 0; --d, rest /= width)
      points(d, p) = values[static_cast<std::size_t>(rest % width)];
  return points;
}

/// The deviations of all parameters, from those of the lengths.
MatrixXd deviations_of(const DesignSpace& space, const MatrixXd& of_lengths) {
  MatrixXd all = MatrixXd::Zero(space.size(), of_lengths.cols());
  all(lengths_of(space), Eigen::all) = of_lengths;
  return all;
}

/// The deviation within the box at which a row of values_at() is smallest (sign 1) or largest (-1),
/// and its value there; NaN at one that has none.
struct Extreme {
  Parameters deviation;
  double value;
};

Extreme extreme_in_box(const DesignProblem& problem, const Parameters& centre, double deviation,
                       Index row, double sign, std::uint64_t& integrated) {
  const std::vector<Index> lengths = lengths_of(problem.space);
  const VectorXd scale = centre(lengths).cwiseAbs().cwiseMax(deviation);
  const auto deviation_of = [&](const MatrixXd& x) {
    return deviations_of(problem.space, scale.asDiagonal() * x);
  };
  const auto functions = [&](const MatrixXd& points) {
    integrated += static_cast<std::uint64_t>(points.cols());
    const MatrixXd parameters = deviation_of(points).colwise() + centre;
    return MatrixXd(-sign * values_at(problem, parameters).row(row));
  };
  const VectorXd reach = deviation * scale.cwiseInverse();
  const NonlinearProgram program{functions, 1, 0, -reach, reach};

  std::vector<double> values{-1, 0, 1};
  if (lengths.size() == 3) values = {-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1};
  const MatrixXd lattice = reach.asDiagonal() * combinations(values, std::ssize(lengths));
  const MatrixXd found = functions(lattice);
  for (Index p = 0; p < found.cols(); ++p)
    if (std::isnan(found(p))) return {deviation_of(lattice.col(p)), no_value};
  Index start = 0;
  found.row(0).maxCoeff(&start);
  const Point worst = search(program, lattice.col(start)).point;
  return {deviation_of(worst.x), -sign * worst.objective};
}

std::vector<Deviation> vertices(const DesignSpace& space, double deviation, double weight) {
  const MatrixXd signs = combinations({-1, 1}, std::ssize(lengths_of(space)));
  const MatrixXd deviations = deviations_of(space, deviation * signs);
  std::vector<Deviation> all;
  for (const auto& by : deviations.colwise()) all.push_back({by, weight, true});
  return all;
}

/// The nodes of the mean over the box.
template <unsigned count>
std::vector<Deviation> gauss_nodes(const DesignSpace& space, double deviation) {
  using Gauss = boost::math::quadrature::gauss<double, count>;
  std::vector<double> nodes, weights;  // of the mean over [-1, 1]
  for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i)
    for (const double sign : {-1.0, 1.0})
      if (Gauss::abscissa()[i] != 0 || sign > 0) {
        nodes.push_back(sign * Gauss::abscissa()[i]);
        weights.push_back(Gauss::weights()[i] / 2);
      }
  const Index lengths = std::ssize(lengths_of(space));
  const MatrixXd by = deviations_of(space, deviation * combinations(nodes, lengths));
  const MatrixXd products = combinations(weights, lengths).colwise().prod();
  std::vector<Deviation> all;
  for (Index i = 0; i < by.cols(); ++i) all.push_back({by.col(i), products(i), false});
  return all;
}

std::vector<Deviation> quadrature(const DesignSpace& space, double deviation) {
  return lengths_of(space).size() == 3 ? gauss_nodes<7>(space, deviation)
                                       : gauss_nodes<3>(space, deviation);
}

/// Adds a deviation, instead of one that is close to it and of the same kind, unless that is one of
/// the `permanent` first ones.
void add_or_replace(std::vector<Deviation>& deviations, std::size_t permanent, double close,
                    const Deviation& added) {
  const auto is_close = [&](const Deviation& known) {
    return (known.by - added.by).lpNorm<Eigen::Infinity>() < close &&
           known.constrained == added.constrained;
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

Robustness robustness(const DesignProblem& problem, const Parameters& parameters, double deviation,
                      std::uint64_t& integrated) {
  const double scale = problem.scales.front();
  const auto [where, worst] = extreme_in_box(problem, parameters, deviation, 0, 1, integrated);
  if (std::isnan(worst)) return {no_value, no_value, parameters + where};
  const std::vector<Deviation> nodes = quadrature(problem.space, deviation);
  MatrixXd all(parameters.size(), std::ssize(nodes));
  for (Index i = 0; const Deviation& node : nodes) all.col(i++) = parameters + node.by;
  integrated += nodes.size();
  const MatrixXd values = values_at(problem, all);
  double expected = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    expected += nodes[i].weight * values(0, static_cast<Index>(i));
  return {worst * scale, expected * scale, std::nullopt};
}

DesignSpace robust_space(const Job& job, DesignSpace space, double deviation) {
  constexpr double inside = 1 + 1e-10;  // the bounds are open
  const auto& variables = job.optimum.variables;
  double low = HUGE_VAL;
  for (const std::vector<double>& values : corners(variables)) {
    const Job at = with_variables(job, VectorXd::Map(values.data(), std::ssize(values)));
    low = std::min(low, arm_bounds(at.scene).low);
  }
  const std::array possible{low, 0.0, 0.0};
  for (Index d = 0; d < length_count; ++d)
    if (space.lower(d) < space.upper(d))
      space.lower(d) =
          std::max(space.lower(d), (possible[static_cast<std::size_t>(d)] + deviation) * inside);
  // r1 and the variables in its bound may be off at once.
  double room = deviation;
  for (const char* const key :
       {"scene.release-height", "scene.fulcrum-height", "scene.counterweight-hanger"})
    if (std::ranges::count(variables, key, &Variable::key) > 0) room += deviation;
  for (SpaceLimit& limit : space.limits)
    if (limit.text.starts_with("r1 >="))
      limit.excess = [=, excess = limit.excess](const Scene& scene, const Design<double>& design) {
        return excess(scene, design) + room * inside;
      };
  return space;
}

KktPoint robust_search(const DesignProblem& problem, const Parameters& start, Robust robust,
                       double deviation, std::uint64_t& integrated) {
  const bool mean = robust == Robust::expected;
  const Aggregate aggregate = mean ? Aggregate::mean : Aggregate::worst;
  std::vector<Deviation> deviations = vertices(problem.space, deviation, mean ? 0 : 1);
  if (mean) {
    const std::vector<Deviation> nodes = quadrature(problem.space, deviation);
    deviations.insert(deviations.end(), nodes.begin(), nodes.end());
  }
  const std::size_t permanent = deviations.size();
  const auto fields = static_cast<Index>(problem.constraints.size());
  constexpr int rounds = 20;
  constexpr double precision = 1e-10;
  KktPoint found;
  VectorXd x = to_scaled(problem, start);
  for (int round = 0; round < rounds; ++round) {
    found = search(program_of(problem, deviations, aggregate, integrated), x);
    const auto constrained = std::ranges::count_if(deviations, &Deviation::constrained);
    found.multipliers = summed(found.multipliers, fields, constrained);
    if (!is_feasible(found.point)) return found;
    x = found.point.x;
    bool exact = true;
    for (Index row = mean ? 1 : 0; row <= fields; ++row) {
      const bool objective = row == 0;
      const Extreme extreme = extreme_in_box(problem, to_parameters(problem, x), deviation, row,
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
