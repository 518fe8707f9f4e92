#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>

namespace trebsweep {

/// Functions of n variables, evaluated at many points at once: takes a column per point, returns a
/// row per function and a column per point. NaN where a function has no value.
using Functions = std::function<Eigen::MatrixXd(const Eigen::MatrixXd& points)>;

/// Where functions have values as far as is known: lower <= x <= upper. Everywhere if empty.
struct Domain {
  Eigen::VectorXd lower = {}, upper = {};
};

/// To maximize the smallest of the objectives f(x), subject to constraints c(x) <= 0 and lower <= x
/// <= upper. Variables and constraints are scaled to the order of one.
struct NonlinearProgram {
  Functions functions;  ///< the objectives, then the constraints
  Eigen::Index objectives, constraints;
  Eigen::VectorXd lower, upper;
  /// Of points that differ only in the first variables, so many, many cost little more than one.
  Eigen::Index cheap_variables = lower.size();
  Domain domain = {};
  /// Whether the start is close to a kink that the objectives and constraints make together:
  /// derivatives then vary much within a hundredth, and the first multipliers matter.
  bool is_at_kink = false;

  Eigen::Index variables() const { return lower.size(); }
};

/// A point of a nonlinear program.
struct Point {
  Eigen::VectorXd x;
  double objective;  ///< the smallest of the objectives
  double
      violation;  ///< the largest of the constraints and 0; infinite where a function has no value
};

/// Constraints count as satisfied up to this, which is above rounding errors.
inline constexpr double feasibility_tolerance = 1e-10;

/// A violation of constraints from which Newton's method does not lead away.
inline constexpr double little_violation = 0.01;

/// Whether a Point, or another struct with its last two members, satisfies the constraints.
template <class P>
bool is_feasible(const P& point) {
  return point.violation <= feasibility_tolerance;
}

/// The point whose functions have these values.
inline Point point_of(const NonlinearProgram& program, const Eigen::VectorXd& x,
                      const Eigen::VectorXd& values) {
  if (!values.allFinite()) return {x, 0, std::numeric_limits<double>::infinity()};
  const double violation =
      program.constraints == 0 ? 0 : values.tail(program.constraints).maxCoeff();
  return {x, values.head(program.objectives).minCoeff(), std::max(violation, 0.0)};
}

/// Whether a is better than b: feasible rather than not, then by objective or by violation.
template <class P>
bool is_better(const P& a, const P& b) {
  if (is_feasible(a) != is_feasible(b)) return is_feasible(a);
  return is_feasible(a) ? a.objective > b.objective : a.violation < b.violation;
}

}  // namespace trebsweep
