#pragma once

#include "trebsweep/optimum/newton.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// How far a search goes: quick ones stop where Newton's method fails, and do not look for better
/// points around the result.
enum class Effort { quick, thorough };

/// The local optimum that a search from x reaches, by Newton's method or, where that fails or x
/// violates the constraints, by lattices of decreasing spacing and Newton's method from their best
/// point. The best point of a small lattice around it must not be better; otherwise the search
/// continues from there. Without a feasible point, the one with the smallest violation. Not
/// converged where the constraints are violated, or where Newton's method fails, because functions
/// have a kink or no value next to the optimum; its multipliers are then zero.
KktPoint search(const NonlinearProgram& program, const Eigen::VectorXd& x,
                Effort effort = Effort::thorough);

}  // namespace trebsweep
