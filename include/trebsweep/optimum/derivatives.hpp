#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// A derivative and an estimate of its error.
struct Derivative {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::infinity();
};

/// Extrapolates difference quotients to a step of zero (Ridders, Advances in Engineering Software 4
/// (1982) 75). quotients[k] belongs to the step h/2^k; `order` is that of their error, 2 for
/// central differences and 1 for one-sided ones, which also is the difference between the orders of
/// successive terms. Quotients that are NaN are left out; NaN if all are.
Derivative extrapolate(std::span<const double> quotients, int order);

/// The values and derivatives of functions at a point.
struct Expansion {
  Eigen::VectorXd values;                 ///< a row per function
  Eigen::MatrixXd gradients;              ///< a row per function, a column per variable
  std::vector<Eigen::MatrixXd> hessians;  ///< one per function; empty if not requested
};

/// Steps of differences: the largest and its halves.
struct Steps {
  double largest;
  int levels;
};

/// Steps for variables of the order of one. The smallest ones serve where larger ones lead to
/// points without a value.
inline constexpr Steps accurate_steps{0.01, 10};

/// Steps for derivatives that lead a search, at a third of the cost.
inline constexpr Steps quick_steps{1e-3, 3};

/// Derivatives by extrapolated differences: central ones or, where these would leave the domain to
/// one side, one-sided ones. Takes 1 + 2 n levels evaluations for n
/// variables without Hessians, 1 + n (n + 1) levels with them, in a single call of `functions`.
Expansion expand(const Functions& functions, const Eigen::VectorXd& x, const Steps& steps,
                 bool with_hessians, const Domain& domain = {});

}  // namespace trebsweep
