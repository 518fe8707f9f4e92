#pragma once

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// The fastest shot of a sweep.
struct Optimum {
  Design<double> design;
  double speed;         ///< m/s
  double release_time;  ///< s
};

/// What a sweep came to, over all ranks.
struct Summary {
  std::array<std::uint64_t, status_names.size()> statuses{};  ///< designs of each Status
  std::uint64_t steps = 0;                                    ///< tried over all swings
  std::uint64_t lane_steps = 0;                               ///< made by lanes, idle ones too
  std::optional<Optimum> optimum;                             ///< none if nothing was released
  double integration_seconds = 0;                             ///< of every round the slowest rank's
  double sweep_seconds = 0;                                   ///< integration and writing
  bool complete = true;  ///< no, where the sweep was told to stop
  bool begun = true;     ///< no, where that was before there was a partial file

  std::uint64_t designs() const;

  /// The share of the lanes' steps that were a design's.
  double utilisation() const;
};

/// What some of the designs came to: those of a tile, or those that one rank has seen.
struct Tally {
  std::array<std::uint64_t, status_names.size()> statuses{};
  std::uint64_t steps = 0, lane_steps = 0;
  double best_speed = -1;
  double best_time = -1;
  std::uint64_t best_cell = std::numeric_limits<std::uint64_t>::max();
  /// Of rounds, all ranks together: counted once for each round, so that they can be summed.
  double integration_seconds = 0, sweep_seconds = 0;

  std::uint64_t designs() const;

  /// Adds a design's shot; `cell` is its number in the lattice's box, which decides between equals;
  /// `competes` says whether it may be the optimum.
  void add(const SwingResult& result, std::uint64_t cell, bool competes = true);

  void add(const Tally& other);
};

/// The columns of a tally in the archive: designs of each status, and the rest.
inline constexpr auto tally_columns = [] {
  constexpr std::array<std::string_view, 7> rest{
      "steps",     "lane_steps",          "best_speed",   "best_release_time",
      "best_cell", "integration_seconds", "sweep_seconds"};
  std::array<std::string_view, status_names.size() + rest.size()> columns;
  std::copy(rest.begin(), rest.end(),
            std::copy(status_names.begin(), status_names.end(), columns.begin()));
  return columns;
}();

/// A tally as it is stored; no count comes near 2^53, where doubles skip numbers.
using TallyRow = std::array<double, tally_columns.size()>;

TallyRow to_row(const Tally& tally);

/// Throws std::runtime_error where the row is none.
Tally to_tally(const TallyRow& row);

/// What a tally of designs of a lattice with those axes (r1, r3, r2) says.
Summary to_summary(const Tally& tally, const std::array<std::vector<double>, 3>& axes);

/// The sum of what all ranks have seen, on all ranks; collective.
Summary combine(const Tally& tally, const Lattice& lattice, MPI_Comm comm);

/// The summary as text for people: lines, the last one open to be gone on with.
std::string to_text(const Summary& summary, OptimumFilter optimum_filter);

}  // namespace trebsweep
