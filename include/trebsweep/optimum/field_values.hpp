#pragma once

#include <Eigen/Core>
#include <span>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// How accurately designs are integrated, whatever the job's stepper and tolerance.
enum class Accuracy {
  coarse,  ///< by vern8 at a tolerance of 1e-6
  high,    ///< by vern8 at 1e-13, as in integrate_accurately()
  check    ///< the same by another stepper
};

/// The solver of Accuracy::coarse.
Solver coarse_solver(const Solver& solver);

/// The values of fields at designs, a row per field and a column per design; NaN without a release.
Eigen::MatrixXd field_values(const Scene& scene, const Solver& solver, Accuracy accuracy,
                             std::span<const Design<double>> designs,
                             std::span<const Field> fields);

}  // namespace trebsweep
