#pragma once

#include <mpi.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// A design of a sweep, integrated again by the job's solver and accurately.
struct Check {
  Design<double> design;
  double speed, efficiency, accurate_speed;
  /// The field and objectives(), computed only of the optimum, its neighbours and the first design
  /// of each status; else NaN.
  double slack, objective;
  Status status, accurate_status;

  /// m/s; NaN if either swing has no release.
  double error() const { return std::abs(speed - accurate_speed); }
};

/// The checked designs of a sweep, and the error of its speeds.
struct ErrorSample {
  std::vector<Check> checks;
  std::optional<MeasuredError> error;  ///< nothing if no checked design has a speed
};

/// Measures the error of a complete sweep's speeds on a sample of the lattice: 128 to 2048 designs
/// spread evenly; the optimum, its neighbours and the first design of each status; and, twice, 16
/// designs near the one with the largest error so far: those whose speeds change most with a tenth
/// of the tolerance or half the step. The accurate speeds are those of integrate_accurately(), and
/// of speed_in_extended_precision() at the optimum. Designs that could not be integrated accurately
/// are left out. So are those not begun within a second, or 1 % of the sweep's time if that is
/// longer, except for the optimum, its neighbours and the first design of each status; otherwise
/// the result depends on the job alone. Collective; the same on all ranks.
/// Returns nothing once `stop` is true on any rank.
std::optional<ErrorSample> measure_error(const Job& job, const Lattice& lattice,
                                         const Summary& summary, const std::function<bool()>& stop,
                                         MPI_Comm comm);

}  // namespace trebsweep
