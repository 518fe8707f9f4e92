#pragma once

#include <mpi.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/results.hpp"

namespace trebsweep {

/// A design of a sweep, integrated again by the job's solver and accurately.
struct Check {
  Design<double> design;
  SwingResult result, accurate;
  double efficiency;
  /// The field and objective(), computed only of the optimum, its neighbours and the first design
  /// of each status; else NaN.
  double slack, objective;
  bool spread = false;  ///< whether it is one of those spread evenly over the lattice

  /// Of the speed, m/s; NaN if either swing has no release.
  double error() const { return std::abs(result.speed - accurate.speed); }
};

/// The checked designs of a scene.
struct ErrorSample {
  std::uint64_t scene = 0;
  std::vector<Check> checks;
  /// The error of the speed of its lattice's best design, m/s.
  double at_best = std::numeric_limits<double>::quiet_NaN();
};

/// Checks designs of a complete sweep: in the scene of the optimum, in that of the first design of
/// each status, and in eight spread evenly, which are returned in ascending order. In each 128 to
/// 2048 designs of the lattice spread evenly; the best design, its neighbours and the first design
/// of each status; and, twice, 16 designs near the one with the largest error so far: those whose
/// speeds change most with a tenth of the tolerance or half the step. The accurate speeds are those
/// of integrate_accurately(), and of speed_in_extended_precision() at the best design. Designs that
/// could not be integrated accurately are left out. So are those of a scene not begun within a
/// second, or within 1 % of the time of the sweep divided by the number of scenes, except for the
/// best design, its neighbours and the first design of each status; otherwise the result depends on
/// the job alone. Collective; `totals` and the result are the same on all ranks. Returns nothing
/// once `stop` is true on any rank.
std::optional<std::vector<ErrorSample>> check_scenes(const Study& study, const Totals& totals,
                                                     const std::function<bool()>& stop,
                                                     MPI_Comm comm);

/// The error of the speeds of a sweep from the checks of its scenes; nothing if no checked design
/// has a speed. `scene` is that of the optimum.
std::optional<MeasuredError> measured_error(std::span<const ErrorSample> samples,
                                            std::uint64_t scene);

}  // namespace trebsweep
