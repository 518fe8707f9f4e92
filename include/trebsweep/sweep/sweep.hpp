#pragma once

#include <mpi.h>

#include <functional>
#include <optional>
#include <string>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/sweep/progress.hpp"

namespace trebsweep {

/// How a sweep is run; nothing here changes its results.
struct SweepOptions {
  bool overwrite = false;  ///< replace an archive, or the partial of one, that is there
  ProgressStyle progress = ProgressStyle::automatic;
  std::string command;                   ///< as typed, for the archive's history
  std::optional<Index3> tile_edge = {};  ///< largest extent of a tile, else chosen for the lattice
  std::function<bool()> stop = [] { return false; };  ///< asked often, on every rank
};

/// Integrates every design of the job's lattice, or those that interrupted sweeps of it have left,
/// and writes the archive; collective. Where a rank is told to stop, all do, with what is done kept
/// in the partial file. The summary is the same on all ranks; nothing if the archive of this very
/// job was there already. Throws on all ranks InputError, where the job or the place of its archive
/// is at fault, and RootError, where an unfinished sweep cannot be continued or a file not be made.
std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm);

}  // namespace trebsweep
