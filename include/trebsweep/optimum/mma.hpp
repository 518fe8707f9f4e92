#pragma once

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The best point that NLopt's method of moving asymptotes (MMA; K. Svanberg, SIAM J. Optim. 12
/// (2002) 555) visits on its way from `start` to a local optimum, to which it comes close.
Point search_by_mma(const NonlinearProgram& program, const Eigen::VectorXd& start);

}  // namespace trebsweep
