#pragma once

#include <Eigen/Core>

#include "trebsweep/model/motion.hpp"

namespace trebsweep {

template <Effects E>
using Jacobian =
    Eigen::Matrix<double, static_cast<int>(coordinates<E>), static_cast<int>(coordinates<E>)>;

/// The Jacobian of the right-hand side, row i the gradient of rate i: forward-mode automatic
/// differentiation of the equations of motion.
template <Effects E>
Jacobian<E> jacobian(const Motion<double, E>& motion, const State<double, E>& x);

}  // namespace trebsweep
