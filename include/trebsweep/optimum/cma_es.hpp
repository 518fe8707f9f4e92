#pragma once

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// The best point that an evolution strategy with covariance matrix adaptation (CMA-ES) finds from
/// a start, for functions with kinks, jumps and points without values. `spread` holds the standard
/// deviations of its first samples. Ends when its samples differ by about a thousandth, or after
/// 200 generations. Always takes the same samples. N. Hansen, The CMA Evolution Strategy: A
/// Tutorial, arXiv:1604.00772, with the Cholesky factor instead of the square root of the matrix.
Point evolve(const NonlinearProgram& program, const Eigen::VectorXd& start,
             const Eigen::VectorXd& spread);

}  // namespace trebsweep
