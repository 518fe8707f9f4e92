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
  StatusCounts statuses{};             ///< designs of each Status
  std::uint64_t steps = 0;             ///< tried, over all designs
  double utilisation = 0;              ///< fraction of the lanes' steps with a design
  std::vector<BestDesign> optima;      ///< of each scene, as far as known
  std::optional<MeasuredError> error;  ///< nothing if it was not measured
  double integration_seconds = 0;      ///< s: mean over the ranks
  double sweep_seconds = 0;            ///< s: with writing, likewise
  bool complete = true;                ///< false if the sweep was stopped

  std::uint64_t designs() const { return sum(statuses); }

  /// The scene with the best optimum; nothing if no design qualifies.
  std::optional<std::uint64_t> best() const { return best_scene(optima); }
};

}  // namespace trebsweep
