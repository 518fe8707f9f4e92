#pragma once

#include <array>
#include <span>

#include "trebsweep/assess/error_quantiles.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {

/// Errors and cost of a solver on a sample of designs. Trivially copyable, so that ranks can
/// exchange it.
struct MeasuredAccuracy {
  std::array<double, status_names.size()> statuses{};  ///< number of designs with each Status
  /// Designs with a release in the solver's results but not in the reference, or vice versa.
  double status_mismatches = 0;
  // Errors of the designs that have a release in both:
  ErrorQuantiles speed;       ///< |error of the speed|, m/s
  ErrorQuantiles relative;    ///< |relative error of the speed|
  ErrorQuantiles time;        ///< |error of the release time|, s
  double drift;               ///< largest |energy-drift|
  double reference_error;     ///< median error bound of the reference speeds, m/s
  double steps, evaluations;  ///< mean per design
  double seconds;             ///< run time per design
};

/// Integrates a sample and compares it with its references; references[n] belongs to designs[n].
/// The run time is the median of `repeats` runs of the sample, repeated until it fills the SIMD
/// lanes; runs of more than 0.3 s are timed once.
MeasuredAccuracy accuracy(const Scene& scene, const Solver& solver,
                          std::span<const Design<double>> designs,
                          std::span<const Reference> references, int repeats);

}  // namespace trebsweep
