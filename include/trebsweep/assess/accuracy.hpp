#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/swing/reference.hpp"

namespace trebsweep {

/// Sizes of some errors; NaN of none.
struct ErrorQuantiles {
  double median, p95, largest;
};

ErrorQuantiles error_quantiles(std::vector<double> errors);

/// What a solver makes of a sample of designs. Numbers alone: ranks exchange it as an array.
struct Accuracy {
  std::array<double, status_names.size()> statuses{};  ///< designs of each Status
  double status_mismatches =
      0;  ///< designs that are a shot here and not in the reference, or the other way round
  ErrorQuantiles speed;       ///< errors of the speed, m/s
  ErrorQuantiles relative;    ///< and relative to it
  ErrorQuantiles time;        ///< errors of the release time, s
  double drift;               ///< largest size of the field energy-drift
  double steps, evaluations;  ///< per design
  double seconds;             ///< per design
  double reference_error;     ///< m/s: the reference's own error, its median
};

/// Integrates a sample by a solver: errors against its references, and the run time, as a median of
/// so many repeats, of the sample taken often enough that lanes are full.
Accuracy accuracy(const Scene& scene, const Solver& solver, std::span<const Design<double>> designs,
                  std::span<const Reference> references, int repeats);

}  // namespace trebsweep
