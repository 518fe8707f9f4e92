#include "trebsweep/optimum/safety.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "trebsweep/optimum/sobol.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double default_deviation = 1e-3;  // relative
constexpr double jump = 1e-3;               // relative to the value, or a constraint's scale

/// The points of a cube of 3^3 around the origin in the three lengths, without it, and one to each
/// side for each variable; a column each.
MatrixXd directions(Index parameters) {
  const Index variables = parameters - length_count;
  MatrixXd all = MatrixXd::Zero(parameters, 26 + 2 * variables);
  for (int k = 0, column = 0; k < 27; ++k)
    if (k != 13) all.col(column++).head(3) << k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1;
  for (Index i = 0; i < variables; ++i)
    for (const Index side : {0, 1}) all(length_count + i, 26 + 2 * i + side) = side == 0 ? -1 : 1;
  return all;
}

/// What 0.1 % of each parameter is a part of.
Parameters sizes(const DesignSpace& space, const Parameters& parameters) {
  constexpr double little = 0.01;  // of the scale
  Parameters all = parameters.cwiseAbs();
  for (Index d = length_count; d < all.size(); ++d)
    if (const double scale = scale_of(space, d); all(d) < little * scale) all(d) = scale;
  return all;
}

/// The objective and the violations of the constraints, a column per design.
MatrixXd counted_values(const DesignProblem& problem, const MatrixXd& parameters, Accuracy accuracy,
                        std::uint64_t& integrated) {
  integrated += static_cast<std::uint64_t>(parameters.cols());
  MatrixXd values = values_at(problem, parameters, accuracy);
  auto constraints = values.bottomRows(values.rows() - 1);
  constraints = constraints.unaryExpr([](double v) { return v < 0 ? 0 : v; });  // NaN stays
  return values;
}

/// Whether the values of a function differ by a jump, or one of them does not exist. That of the
/// objective, the first function, is relative to a magnitude. A constraint, any other function,
/// jumps only where it becomes violated.
bool differ(Index function, double a, double b, double magnitude) {
  return function == 0 ? !(std::abs(a - b) <= jump * magnitude) : !(b - a <= jump);
}

/// A direction in which a function changes by more than a jump.
struct Change {
  Index function;
  Parameters towards;
  double here, there;  // values at the start and the end
};

/// Whether bisection ends at a jump of a function, rather than at a steep slope.
bool jumps(const DesignProblem& problem, const Parameters& parameters, double magnitude,
           const Change& change, Accuracy accuracy, std::uint64_t& integrated) {
  constexpr int rounds = 30;
  double low = 0, high = 1, at_low = change.here, at_high = change.there;
  for (int round = 0; round < rounds; ++round) {
    const double middle = (low + high) / 2;
    const double value = counted_values(problem, parameters + middle * change.towards, accuracy,
                                        integrated)(change.function, 0);
    // A missing value is beyond any difference.
    const bool below = std::isnan(value) || (!std::isnan(at_high) &&
                                             std::abs(value - at_low) > std::abs(at_high - value));
    (below ? high : low) = middle;
    (below ? at_high : at_low) = value;
    if (!differ(change.function, at_low, at_high, magnitude)) return false;
  }
  return true;
}

/// Sets to zero by how much a variable is off where its key does not allow it, such as a height
/// below zero; a column per design.
void keep_allowed(const std::vector<Variable>& variables, const Parameters& parameters,
                  MatrixXd& off) {
  for (Index i = length_count; const Variable& variable : variables) {
    for (double& by : off.row(i))
      if (!allows(variable, parameters(i) + by)) by = 0;
    ++i;
  }
}

/// Parameters that satisfy the constraints, with their objective.
struct Candidate {
  Parameters parameters;
  double objective;
};

bool are_inside(const DesignProblem& problem, const Parameters& parameters) {
  const DesignSpace& space = problem.space;
  for (Index d = 0; d < space.size(); ++d) {
    const double rounding = feasibility_tolerance * scale_of(space, d);
    if (parameters(d) < space.lower(d) - rounding || parameters(d) > space.upper(d) + rounding)
      return false;
  }
  const MachineFamily machine = at(problem.machine, parameters);
  const Design<double> design = to_design(parameters);
  return std::ranges::all_of(space.limits, [&](const SpaceLimit& limit) {
    return limit.excess(machine.scene, design) <=
           feasibility_tolerance * problem.machine.scene.fulcrum_height;
  });
}

/// Those of some parameters that satisfy the constraints, best first.
std::vector<Candidate> candidates(const DesignProblem& problem, const MatrixXd& parameters,
                                  std::uint64_t& integrated) {
  std::vector<Index> inside;
  for (Index i = 0; i < parameters.cols(); ++i)
    if (are_inside(problem, parameters.col(i))) inside.push_back(i);
  std::vector<Candidate> found;
  if (inside.empty()) return found;
  integrated += inside.size();
  const MatrixXd values = values_at(problem, parameters(Eigen::all, inside));
  for (Index i = 0; i < values.cols(); ++i) {
    const auto column = values.col(i);
    const bool satisfied =
        column.size() == 1 || column.tail(column.size() - 1).maxCoeff() <= feasibility_tolerance;
    if (column.allFinite() && satisfied)
      found.push_back({parameters.col(inside[static_cast<std::size_t>(i)]), column(0)});
  }
  std::ranges::stable_sort(found, std::greater{}, &Candidate::objective);
  return found;
}

/// A search for a safe design.
struct SafeSearch {
  const DesignProblem& problem;
  double deviation;
  std::uint64_t integrated = 0;

  bool is_exhausted() const {
    constexpr std::uint64_t most = 30'000;
    return integrated > most;
  }
};

/// The best of some parameters that are safe and better than a value; nothing if the search is
/// exhausted first. Coarse swings, in a fifth of the time, rule out most of those that are not
/// safe, and seldom another.
std::optional<Candidate> best_safe(SafeSearch& search, const MatrixXd& parameters,
                                   double better_than) {
  const auto is_safe = [&](const Candidate& candidate, Accuracy accuracy) {
    return are_safe(search.problem, candidate.parameters, search.deviation, accuracy,
                    search.integrated);
  };
  for (const Candidate& candidate : candidates(search.problem, parameters, search.integrated)) {
    if (!(candidate.objective > better_than) || search.is_exhausted()) break;
    if (is_safe(candidate, Accuracy::coarse) && is_safe(candidate, Accuracy::high))
      return candidate;
  }
  return std::nullopt;
}

/// Parameters around others, up to a multiple of the tolerated deviations from them; fixed ones
/// stay.
MatrixXd around(const SafeSearch& search, const Parameters& parameters, double multiple) {
  const Index variables = parameters.size() - length_count;
  const bool has_variables = variables > 0;
  Parameters reach = Parameters::Zero(parameters.size());
  const DesignProblem& problem = search.problem;
  reach(problem.free) =
      multiple * tolerated(problem.space, parameters, search.deviation)(problem.free);
  const MatrixXd far = reach.asDiagonal() * directions(parameters.size());
  constexpr Index within = 96;  // the sides of the variables are few
  // Designs of one scene, which fill the lanes.
  const Index of_scene = (reach.head(length_count).array() > 0).any() ? 8 : 1;
  MatrixXd by(parameters.size(), far.cols() + (has_variables ? within : 0));
  by.leftCols(far.cols()) = far;
  if (has_variables) {
    MatrixXd points = SobolSequence(-reach, reach).next(within);
    for (Index i = 0; i < within; ++i)
      points.col(i).tail(variables) = points.col(i - i % of_scene).tail(variables);
    by.rightCols(within) = points;
  }
  std::vector<Index> distinct;
  for (Index i = 0; i < by.cols(); ++i) {
    const auto is_same = [&](Index j) { return by.col(i) == by.col(j); };
    if (!by.col(i).isZero(0) && std::ranges::none_of(distinct, is_same)) distinct.push_back(i);
  }
  return by(Eigen::all, distinct).colwise() + parameters;
}

}  // namespace

Parameters tolerated(const DesignSpace& space, const Parameters& parameters, double deviation) {
  Parameters reach = default_deviation * sizes(space, parameters);
  for (Index d = 0; d < reach.size() && deviation > 0; ++d)
    if (space.units[static_cast<std::size_t>(d)] == "m") reach(d) = deviation;
  return reach;
}

bool are_safe(const DesignProblem& problem, const Parameters& parameters, double deviation,
              Accuracy accuracy, std::uint64_t& integrated) {
  const Index n = parameters.size();
  const Parameters half = default_deviation / 2 * sizes(problem.space, parameters);
  const MatrixXd sides = half.asDiagonal() * MatrixXd::Identity(n, n);
  const MatrixXd far = tolerated(problem.space, parameters, deviation).asDiagonal() * directions(n);
  MatrixXd near(n, 1 + 2 * n), away(n, 2 * far.cols());
  near << Parameters::Zero(n), -sides, sides;
  away << 0.5 * far, far;
  keep_allowed(problem.machine.variables, parameters, near);
  keep_allowed(problem.machine.variables, parameters, away);

  constexpr double largest_loss = 0.02;
  const double magnitude = magnitude_at(problem, parameters);
  const MatrixXd values =
      counted_values(problem, near.colwise() + parameters, accuracy, integrated);
  if (!(values.row(0).minCoeff<Eigen::PropagateNaN>() > values(0, 0) - largest_loss * magnitude))
    return false;
  const MatrixXd others =
      counted_values(problem, away.colwise() + parameters, accuracy, integrated);
  if (others.hasNaN()) return false;
  for (Index i = 0; i < others.cols(); ++i)
    for (Index f = 0; f < others.rows(); ++f) {
      const double here = values(f, 0), there = others(f, i);
      if (differ(f, here, there, magnitude) &&
          jumps(problem, parameters, magnitude, {f, away.col(i), here, there}, accuracy,
                integrated))
        return false;
    }
  return true;
}

std::optional<Parameters> safe_parameters_near(const DesignProblem& problem,
                                               const Parameters& parameters, double deviation,
                                               std::uint64_t& integrated) {
  SafeSearch search{problem, deviation};
  std::optional<Candidate> best = best_safe(search, parameters, -HUGE_VAL);
  for (const double multiple : {1.1, 2.0, 4.0, 8.0, 16.0, 40.0, 80.0})
    if (!best && !search.is_exhausted())
      best = best_safe(search, around(search, parameters, multiple), -HUGE_VAL);
  constexpr double farthest = 80, closest = 0.02, least_gain = 1e-6;
  constexpr int most = 60;  // rounds
  double multiple = 2;
  for (int round = 0; best && round < most && multiple > closest && !search.is_exhausted();
       ++round) {
    const double better = best->objective + least_gain * std::abs(best->objective);
    const auto next = best_safe(search, around(search, best->parameters, multiple), better);
    multiple = next ? std::min(2 * multiple, farthest) : multiple / 2;
    if (next) best = next;
  }
  integrated += search.integrated;
  return best ? std::optional(best->parameters) : std::nullopt;
}

}  // namespace trebsweep
