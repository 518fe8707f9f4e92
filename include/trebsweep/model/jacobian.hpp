#pragma once

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

#include "trebsweep/model/motion.hpp"

namespace trebsweep {

template <Effects E>
using Jacobian =
    Eigen::Matrix<double, static_cast<int>(coordinates<E>), static_cast<int>(coordinates<E>)>;

/// The Jacobian of the right-hand side, row i the gradient of rate i: forward-mode automatic
/// differentiation of the equations of motion.
template <Effects E>
Jacobian<E> jacobian(const Motion<double, E>& motion, const State<double, E>& x) {
  constexpr auto n = static_cast<int>(coordinates<E>);
  using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, n, 1>>;
  std::array<Dual, coordinates<E>> dual, rates;
  for (int i = 0; i < n; ++i)
    dual[static_cast<std::size_t>(i)] = Dual(x[static_cast<std::size_t>(i)], n, i);
  motion.rates(dual, directions(dual), rates);
  Jacobian<E> derivatives;
  for (int i = 0; i < n; ++i)
    derivatives.row(i) = rates[static_cast<std::size_t>(i)].derivatives().transpose();
  return derivatives;
}

}  // namespace trebsweep
