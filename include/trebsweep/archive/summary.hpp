#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "trebsweep/archive/best_design.hpp"
#include "trebsweep/archive/tally.hpp"

namespace trebsweep {

/// The error of a sweep's speeds, measured on a sample of the lattice.
struct MeasuredError {
  double median;          ///< m/s: of designs spread evenly over the lattice
  double largest;         ///< m/s: of all designs of the sample
  double at_optimum;      ///< m/s: NaN without an optimum, or if it could not be measured
  std::uint64_t designs;  ///< in the sample
};

/// Result of a sweep, reduced over all ranks.
struct Summary {
  Tally tally;                         ///< of all designs
  std::vector<BestDesign> optima;      ///< of each scene, as far as known
  std::optional<MeasuredError> error;  ///< nothing if it was not measured
  bool complete = true;                ///< false if the sweep was stopped

  /// The scene with the best optimum; nothing if no design qualifies.
  std::optional<std::uint64_t> best() const { return best_scene(optima); }
};

}  // namespace trebsweep
