#pragma once

#include <Eigen/Core>
#include <span>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The values of fields at designs, a row per field and a column per design; NaN without a release.
/// The solver's `tolerance` is used with vern8, whatever its stepper; if it is 0, the designs are
/// integrated accurately.
Eigen::MatrixXd field_values(const Scene& scene, const Solver& solver, double tolerance,
                             std::span<const Design<double>> designs,
                             std::span<const Field> fields);

}  // namespace trebsweep
