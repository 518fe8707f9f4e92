#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "trebsweep/archive/best_design.hpp"
#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// The index of no design.
inline constexpr std::uint64_t no_cell = std::numeric_limits<std::uint64_t>::max();

/// Numbers of designs with each Status.
using StatusCounts = std::array<std::uint64_t, status_names.size()>;

/// Counts and best of a set of designs, such as those of a tile. Tallies of disjoint sets can be
/// added in any order.
struct Tally {
  StatusCounts statuses{};
  std::uint64_t steps = 0;       ///< tried, over all designs
  std::uint64_t lane_steps = 0;  ///< steps of all lanes, including idle ones
  BestDesign best;               ///< of designs of one scene
  /// The lowest index of a design of each Status.
  std::array<std::uint64_t, status_names.size()> first_cells = [] {
    std::array<std::uint64_t, status_names.size()> cells{};
    cells.fill(no_cell);
    return cells;
  }();
  /// The wall time that a rank spent on them, divided by the number of ranks, s: in integrating,
  /// and in all. Sums over all designs are thus means over the ranks.
  double integration_seconds = 0, sweep_seconds = 0;

  std::uint64_t designs() const;

  /// The fraction of the lanes' steps in which the lane held a design.
  double utilisation() const;

  /// Adds the result of one design. `cell` is its index in the flattened lattice boxes, r2 fastest,
  /// and `value` its objective. A design without a release, or with an infinite or NaN objective,
  /// is counted but cannot be the best.
  void add(const SwingResult& result, std::uint64_t cell, const Design<double>& design,
           double value);

  void add(const Tally& other);
};

}  // namespace trebsweep
