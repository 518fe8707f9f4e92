#include "trebsweep/optimum/swing_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trebsweep/swing/swing.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// How far below the largest value, scaled, an extreme may be that a search makes equal to it.
constexpr double close = 0.05;

/// By how much values that are located differently may differ, scaled.
constexpr double rounding = 1e-10;

bool has_extreme(const Expression& expression) {
  return std::ranges::any_of(expression.fields,
                             [](Field field) { return info(field).kind == FieldKind::load; });
}

/// Whether extremes are part of the objective, or of constraints that are nearly active.
bool depends_on_extremes(const DesignProblem& problem, const VectorXd& values) {
  if (has_extreme(problem.objective)) return true;
  for (Index row = 1; const Constraint& constraint : problem.constraints)
    if (values(row++) > -close && has_extreme(constraint.expression)) return true;
  return false;
}

/// Times at which steps of a swing begin, evenly spread over the steps; infinity follows.
std::vector<double> step_times(const MachineFamily& machine, const Parameters& parameters) {
  constexpr std::size_t most = 100;
  const MachineFamily varied = at(machine, parameters);
  std::vector<double> all;
  ObservedSwing observed;
  observed.step = [&](const PlainInstant& from, const PlainInstant&) { all.push_back(from.t); };
  swing(varied.scene, to_design(parameters), solver_of("vern8", 1e-13, varied.solver), observed);
  std::vector<double> times;
  for (std::size_t i = 0, stride = all.size() / most + 1; i < all.size(); i += stride)
    times.push_back(all[i]);
  times.push_back(std::numeric_limits<double>::infinity());
  return times;
}

DesignProblem part_of(DesignProblem problem, const TimeWindow& window) {
  problem.machine.solver.recorded = window;
  return problem;
}

/// The places of the least values between peaks that come close to the largest.
std::vector<Index> valleys(const RowVectorXd& values) {
  constexpr double depth = 1e-6;
  const double high = values.maxCoeff() - close;
  std::vector<Index> found;
  Index peak = 0, valley = 0;
  for (Index k = 1; k < values.size(); ++k) {
    const double lower_peak = std::min(values(peak), values(k));
    if (lower_peak > high && values(valley) < lower_peak - depth) {
      found.push_back(valley);
      peak = valley = k;
    } else if (values(k) >= values(peak)) {
      peak = valley = k;
    } else if (values(k) < values(valley)) {
      valley = k;
    }
  }
  return found;
}

/// The functions that a part of the swing adds to the program of all parts: rows of values_at().
/// The first part has all that are the same in each.
struct PartFunctions {
  std::vector<Index> objectives, constraints;
};

PartFunctions functions_of(const DesignProblem& part, bool is_first) {
  PartFunctions rows;
  if (is_first || has_extreme(part.objective)) rows.objectives.push_back(0);
  for (Index row = 1; const Constraint& constraint : part.constraints) {
    if (is_first || has_extreme(constraint.expression)) rows.constraints.push_back(row);
    ++row;
  }
  return rows;
}

/// To maximize the smallest of the objectives of all parts, subject to the constraints of each and
/// then the limits of the space.
NonlinearProgram program_of(const std::vector<DesignProblem>& parts, std::uint64_t& integrated) {
  NonlinearProgram joint = nominal_program(parts.front(), integrated);
  const Index shared = std::ssize(parts.front().space.limits);
  std::vector<Functions> functions;
  std::vector<PartFunctions> rows;
  joint.objectives = 0;
  joint.constraints = shared;
  joint.is_at_kink = true;
  for (const DesignProblem& part : parts) {
    functions.push_back(nominal_program(part, integrated).functions);
    rows.push_back(functions_of(part, rows.empty()));
    joint.objectives += std::ssize(rows.back().objectives);
    joint.constraints += std::ssize(rows.back().constraints);
  }
  joint.functions = [=, objectives = joint.objectives](const MatrixXd& points) {
    MatrixXd all(objectives + joint.constraints, points.cols());
    Index objective = 0, constraint = objectives;
    for (std::size_t i = 0; i < functions.size(); ++i) {
      const MatrixXd values = functions[i](points);
      for (const Index row : rows[i].objectives) all.row(objective++) = values.row(row);
      for (const Index row : rows[i].constraints) all.row(constraint++) = values.row(row);
      all.bottomRows(shared) = values.bottomRows(shared);
    }
    return all;
  };
  return joint;
}

/// The derivatives of an optimum with respect to the limits() of a problem.
VectorXd derivatives(const DesignProblem& problem, VectorXd multipliers) {
  constexpr double negligible = 1e-9;
  for (Index i = 0; const Limit& limit : limits(problem)) {
    double& multiplier = multipliers(i++);
    multiplier = std::abs(multiplier) < negligible ? 0 : multiplier * limit.factor;
  }
  return multipliers;
}

/// The optimum of a problem from that of the program of its parts. The limits that the parts share
/// belong to the first.
ProblemOptimum combined(const std::vector<DesignProblem>& parts, const KktPoint& joint) {
  ProblemOptimum optimum{joint.point, joint.converged, {}};
  Index weight = 0, multiplier = 0;
  for (const DesignProblem& part : parts) {
    const bool is_first = optimum.parts.empty();
    const auto [objectives, constraints] = functions_of(part, is_first);
    PartOptimum own{part, 0, VectorXd::Zero(std::ssize(limits(part)))};
    for ([[maybe_unused]] const Index row : objectives) own.weight = joint.weights(weight++);
    for (const Index row : constraints) own.derivatives(row - 1) = joint.multipliers(multiplier++);
    optimum.parts.push_back(own);
  }
  VectorXd& first = optimum.parts.front().derivatives;
  const Index shared = joint.multipliers.size() - multiplier;
  first.tail(shared) = joint.multipliers.tail(shared);
  for (PartOptimum& part : optimum.parts)
    part.derivatives = derivatives(part.problem, part.derivatives);
  return optimum;
}

/// The optimum near a point where a search has stopped, with extremes that are equal there; not
/// converged, and perhaps at a better point, if it is not of that kind.
ProblemOptimum search_parts(const DesignProblem& problem, const NonlinearProgram& whole,
                            const KktPoint& stopped, std::uint64_t& integrated) {
  constexpr int rounds = 8;  // the peaks may leave their parts on the way, and others appear
  ProblemOptimum best = undivided(problem, stopped);
  Point point = stopped.point;
  for (int round = 0; round < rounds && point.violation <= little_violation; ++round) {
    const auto parts = split(problem, to_parameters(problem, point.x), integrated);
    if (parts.size() == 1) break;
    const KktPoint joint = solve_kkt(program_of(parts, integrated), point);
    const bool has_moved = joint.point.x != point.x;
    point = point_of(whole, joint.point.x, whole.functions(joint.point.x).col(0));
    if (joint.converged && is_feasible(point) &&
        std::abs(point.objective - joint.point.objective) <= rounding)
      return combined(parts, joint);
    if (!has_moved) break;
    if (is_better(point, best.point)) best.point = point;
  }
  return best;
}

}  // namespace

std::vector<DesignProblem> split(const DesignProblem& problem, const Parameters& parameters,
                                 std::uint64_t& integrated) {
  const VectorXd whole = values_at(problem, parameters);
  ++integrated;
  if (!whole.allFinite() || !depends_on_extremes(problem, whole)) return {problem};
  const std::vector<double> times = step_times(problem.machine, parameters);
  MatrixXd values(whole.size(), std::ssize(times) - 1);
  for (Index k = 0; k < values.cols(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    values.col(k) = values_at(part_of(problem, {times[i], times[i + 1]}), parameters);
  }
  integrated += static_cast<std::uint64_t>(values.cols());
  values.row(0) *= -1;
  std::vector<double> ends{times.back()};
  const auto is_largest_of_parts = [&](Index row) {
    const double largest = row == 0 ? -whole(0) : whole(row);
    return std::abs(values.row(row).maxCoeff() - largest) <= rounding;
  };
  for (Index row = 0; row < values.rows(); ++row)
    if (is_largest_of_parts(row) && (row == 0 || whole(row) > -close))
      for (const Index k : valleys(values.row(row)))
        ends.push_back(times[static_cast<std::size_t>(k)]);
  std::ranges::sort(ends);
  ends.erase(std::ranges::unique(ends).begin(), ends.end());
  std::vector<DesignProblem> parts;
  for (double from = 0; const double end : ends)
    parts.push_back(part_of(problem, {std::exchange(from, end), end}));
  return parts;
}

ProblemOptimum undivided(const DesignProblem& problem, const KktPoint& found) {
  return {found.point, found.converged, {{problem, 1, derivatives(problem, found.multipliers)}}};
}

ProblemOptimum search(const DesignProblem& problem, const Parameters& start, Effort effort,
                      std::uint64_t& integrated) {
  const NonlinearProgram program = nominal_program(problem, integrated);
  const auto with_parts = [&](const KktPoint& found) {
    if (found.converged || found.point.violation > little_violation)
      return undivided(problem, found);
    return search_parts(problem, program, found, integrated);
  };
  const KktPoint quick = search(program, to_scaled(problem, start), Effort::quick);
  const ProblemOptimum near = with_parts(quick);
  if (effort == Effort::quick || (near.converged && !quick.converged)) return near;
  return with_parts(search(program, near.point.x, effort));
}

}  // namespace trebsweep
