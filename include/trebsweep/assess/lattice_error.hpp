#pragma once

#include <mpi.h>

#include <vector>

#include "trebsweep/assess/error_quantiles.hpp"
#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

/// Speeds of designs by one solver.
struct LatticeSpeeds {
  std::vector<double> speeds;  ///< m/s; NaN without a release
  double seconds;              ///< integration time of the slowest rank
};

/// Integrates designs on all ranks; collective, the result is the same on all of them.
LatticeSpeeds lattice_speeds(const Scene& scene, const Solver& solver,
                             const std::vector<Design<double>>& designs, MPI_Comm comm);

/// Errors of a solver's speeds on a whole lattice.
struct LatticeError {
  double seconds;          ///< integration time of the slowest rank
  ErrorQuantiles speed;    ///< |error|, m/s
  double median_relative;  ///< median of the signed relative errors
  double optimum_error;    ///< signed error at the true optimum, m/s
  Design<double> best;     ///< the solver's own optimum
  double best_speed;       ///< m/s
  /// Designs with a release in the solver's results but not in the true ones, or vice versa.
  double status_mismatches;
};

/// Compares a solver's speeds of designs with their true speeds (m/s, NaN without a release);
/// collective.
LatticeError lattice_error(const Scene& scene, const Solver& solver,
                           const std::vector<Design<double>>& designs,
                           const std::vector<double>& truth, MPI_Comm comm);

}  // namespace trebsweep
