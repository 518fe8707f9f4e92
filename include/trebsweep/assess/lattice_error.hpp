#pragma once

#include <mpi.h>

#include <vector>

#include "trebsweep/assess/accuracy.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// How far a solver's speeds are off on a whole lattice.
struct LatticeError {
  double seconds;          ///< of integration, the slowest rank's
  ErrorQuantiles speed;    ///< sizes of the errors, m/s
  double median_relative;  ///< of the errors with their signs
  double optimum_error;    ///< m/s: at the true optimum
  Design<double> best;     ///< the fastest shot of this solver
  double best_speed;       ///< m/s
  double
      status_mismatches;  ///< designs that are a shot here and not in truth, or the other way round
};

/// Speeds of designs by a solver, on all ranks; NaN without a release. Collective. `seconds`
/// becomes the slowest rank's time.
std::vector<double> lattice_speeds(const Scene& scene, const Solver& solver,
                                   const std::vector<Design<double>>& designs, double& seconds,
                                   MPI_Comm comm);

/// Holds a solver's speeds against true ones; collective.
LatticeError lattice_error(const Scene& scene, const Solver& solver,
                           const std::vector<Design<double>>& designs,
                           const std::vector<double>& truth, MPI_Comm comm);

}  // namespace trebsweep
