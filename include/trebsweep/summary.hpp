#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "trebsweep/job.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/shot.hpp"

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
  double integration_seconds = 0;                             ///< the slowest rank's
  double sweep_seconds = 0;  ///< integration and writing, the slowest rank's

  std::uint64_t designs() const;

  /// The share of the lanes' steps that were a design's.
  double utilisation() const;
};

/// What one rank has seen so far.
struct Tally {
  std::array<std::uint64_t, status_names.size()> statuses{};
  std::uint64_t steps = 0, lane_steps = 0;
  double best_speed = -1;
  double best_time = -1;
  std::uint64_t best_cell = std::numeric_limits<std::uint64_t>::max();

  /// Adds a design's shot; `cell` is its number in the lattice's box, which decides between equals;
  /// `competes` says whether it may be the optimum.
  void add(const Shot& shot, std::uint64_t cell, bool competes = true);
};

/// The sum of what all ranks have seen, on all ranks; collective. The times are left for the
/// caller.
Summary combine(const Tally& tally, const Lattice& lattice, MPI_Comm comm);

/// The summary as text for people.
std::string to_text(const Summary& summary, const Job& job, int ranks);

}  // namespace trebsweep
