#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "trebsweep/job.hpp"
#include "trebsweep/progress.hpp"
#include "trebsweep/swing.hpp"

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
  std::optional<Optimum> optimum;                             ///< none if nothing was released
  double integration_seconds = 0;                             ///< the slowest rank's
  double sweep_seconds = 0;  ///< integration and writing, the slowest rank's

  std::uint64_t designs() const;
};

/// How a sweep is run; nothing here changes its results.
struct SweepOptions {
  bool overwrite = false;  ///< replace an archive, or the partial of one, that is there
  ProgressStyle progress = ProgressStyle::automatic;
  std::string command;           ///< as typed, for the archive's history
  Index3 tile_edge{16, 16, 16};  ///< largest extent of a tile
};

/// Integrates every design of the job's lattice and writes the archive; collective. The summary is
/// the same on all ranks; nothing if the archive of this very job was there already. Throws
/// InputError, on all ranks, where the job or the place of its archive is at fault.
std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm);

/// The summary as text for people.
std::string to_text(const Summary& summary, const Job& job, int ranks);

}  // namespace trebsweep
