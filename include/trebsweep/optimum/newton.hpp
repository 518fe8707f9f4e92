#pragma once

#include <Eigen/Core>

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// A solution of the conditions of Karush, Kuhn and Tucker.
struct KktPoint {
  Point point;
  /// How much the optimum grows when a constraint or a bound is relaxed by one: the constraints,
  /// then the lower and the upper bounds. Zero where it is not active.
  Eigen::VectorXd multipliers;
  bool converged;
  Eigen::VectorXd weights = {};  ///< the multipliers of the objectives, which add up to one
};

/// Newton's method for the conditions of Karush, Kuhn and Tucker, from a point that violates the
/// constraints little. (Nocedal and Wright, Numerical Optimization, chapters 16 and 18.) If it does
/// not converge, the best point on the way is returned, without its multipliers.
KktPoint solve_kkt(const NonlinearProgram& program, const Point& start);

}  // namespace trebsweep
