#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// Counts and optimum of a set of designs, such as those of a tile. Tallies of disjoint sets can be
/// added in any order.
struct Tally {
  std::array<std::uint64_t, status_names.size()> statuses{};  ///< designs of each Status
  std::uint64_t steps = 0;                                    ///< steps tried, over all designs
  std::uint64_t lane_steps = 0;  ///< steps of all lanes, including idle ones
  double best_speed = -1;        ///< m/s; -1 if no design has a speed
  double best_time = -1;         ///< release time of the best design, s
  std::uint64_t best_cell = std::numeric_limits<std::uint64_t>::max();
  /// Wall time of whole rounds on all ranks, s. Only one tile of a round carries it, so that the
  /// sum over tiles counts each round once.
  double integration_seconds = 0, sweep_seconds = 0;

  std::uint64_t designs() const;

  /// Adds the result of one design. `cell` is its index in the flattened lattice box, r2 fastest;
  /// of designs with equal speeds the one with the lowest index is the best. A design that does not
  /// compete is counted but cannot be the best.
  void add(const SwingResult& result, std::uint64_t cell, bool competes = true);

  void add(const Tally& other);
};

/// The columns of tile_tally in the archive: the number of designs of each status, then the rest.
inline constexpr auto tally_columns = [] {
  constexpr std::array<std::string_view, 7> rest{
      "steps",     "lane_steps",          "best_speed",   "best_release_time",
      "best_cell", "integration_seconds", "sweep_seconds"};
  std::array<std::string_view, status_names.size() + rest.size()> columns;
  std::copy(rest.begin(), rest.end(),
            std::copy(status_names.begin(), status_names.end(), columns.begin()));
  return columns;
}();

/// A tally as stored. Counts stay far below 2^53, up to which doubles represent every integer.
using TallyRow = std::array<double, tally_columns.size()>;

TallyRow to_row(const Tally& tally);

/// Throws std::runtime_error if the row holds an invalid count.
Tally to_tally(const TallyRow& row);

}  // namespace trebsweep
