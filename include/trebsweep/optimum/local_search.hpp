#pragma once

#include "trebsweep/optimum/newton.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The local optimum that a search from x reaches. NLopt's CCSAQ (K. Svanberg, SIAM J. Optim. 12
/// (2002) 555) comes close to it and Newton's method makes it exact. The best point of a small
/// lattice around it must not be better; otherwise the search continues from there. Without a
/// feasible point, the one with the smallest violation.
KktPoint search(const NonlinearProgram& program, const Eigen::VectorXd& x);

}  // namespace trebsweep
