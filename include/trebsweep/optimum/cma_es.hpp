#pragma once

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The best point that an evolution strategy with covariance matrix adaptation (CMA-ES) finds from
/// a start, for functions with kinks, jumps and points without values. `spread` holds the standard
/// deviations of its first samples. Ends when its samples differ by about a thousandth, after 200
/// generations, or where a deviation is zero. Always takes the same samples; if some variables are
/// not cheap, eight samples share these. Requires a variable. N. Hansen, The CMA Evolution
/// Strategy: A Tutorial, arXiv:1604.00772, but with a Cholesky factor instead of the square root of
/// the matrix, the population success rule for the step size, samples moved to the bounds, and a
/// penalty for violations of the constraints.
Point evolve(const NonlinearProgram& program, const Eigen::VectorXd& start,
             const Eigen::VectorXd& spread);

}  // namespace trebsweep
