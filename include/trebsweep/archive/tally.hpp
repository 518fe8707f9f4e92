#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// The index of no design.
inline constexpr std::uint64_t no_cell = std::numeric_limits<std::int64_t>::max();

/// The best of a set of designs.
struct BestCell {
  /// The objective, in the unit of its field; -infinity without a design.
  double value = -std::numeric_limits<double>::infinity();
  double speed = std::numeric_limits<double>::quiet_NaN();         ///< m/s
  double release_time = std::numeric_limits<double>::quiet_NaN();  ///< s
  std::uint64_t cell = no_cell;  ///< its index in the flattened lattice box, r2 fastest

  bool exists() const { return cell != no_cell; }

  /// Whether it is better than another one. Of equal designs, the first cell is the best.
  bool operator>(const BestCell& other) const {
    return value > other.value || (value == other.value && cell < other.cell);
  }
};

/// Counts and optimum of a set of designs, such as those of a tile. Tallies of disjoint sets can be
/// added in any order.
struct Tally {
  std::array<std::uint64_t, status_names.size()> statuses{};  ///< designs of each Status
  std::uint64_t steps = 0;                                    ///< steps tried, over all designs
  std::uint64_t lane_steps = 0;  ///< steps of all lanes, including idle ones
  BestCell best;
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

  /// Adds the result of one design. `cell` is its index in the flattened lattice box, r2 fastest,
  /// and `value` its objective. A design without a release, or with an infinite or NaN objective,
  /// is counted but cannot be the best.
  void add(const SwingResult& result, std::uint64_t cell, double value);

  void add(const Tally& other);
};

/// The columns of tile_tally in the archive: the number of designs of each status, the rest, and
/// the lowest index of a design of each status.
inline constexpr auto tally_columns = [] {
  constexpr std::array<std::string_view, 8> rest{
      "steps",     "lane_steps",          "best_value",   "best_speed", "best_release_time",
      "best_cell", "integration_seconds", "sweep_seconds"};
  constexpr std::array<std::string_view, 10> first_cells{
      "first_outside_lattice", "first_released",
      "first_not_released",    "first_unreachable_start",
      "first_step_budget",     "first_step_underflow",
      "first_non_finite",      "first_released_below_ground",
      "first_never_lifted",    "first_sling_too_short"};
  static_assert(first_cells.size() == status_names.size());
  std::array<std::string_view, status_names.size() + rest.size() + first_cells.size()> columns;
  auto end = std::copy(status_names.begin(), status_names.end(), columns.begin());
  end = std::copy(rest.begin(), rest.end(), end);
  std::copy(first_cells.begin(), first_cells.end(), end);
  return columns;
}();

/// A tally as stored. Counts stay far below 2^53, up to which doubles represent every integer.
using TallyRow = std::array<double, tally_columns.size()>;

TallyRow to_row(const Tally& tally);

/// Throws std::runtime_error if the row holds an invalid count.
Tally to_tally(const TallyRow& row);

}  // namespace trebsweep
