#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/scene_optima.hpp"

namespace trebsweep {

/// What a sweep will cost.
struct SweepEstimate {
  std::uint64_t designs, scenes, tiles;
  std::uint64_t designs_done;  ///< by earlier runs of an unfinished sweep
  Index3 tile_edge;
  bool complete;          ///< whether the archive exists already
  NeededSpace space;      ///< on disk
  double rank_bytes;      ///< memory of a rank, without the system's cache of files
  double design_seconds;  ///< processor time to integrate the designs that are left, s
  double scene_seconds;   ///< processor time to find the optima of the scenes, s
  /// Why the sweep would be refused; empty if it would not be.
  std::string refusal;
};

/// Estimates a sweep from designs of its own scenes, which all ranks integrate for about a second.
/// Writes nothing. Collective; the result is the same on all ranks. Throws mpi::RootError as
/// check_arithmetic() does.
SweepEstimate estimate(const Study& study, bool overwrite, const Refine& refine, MPI_Comm comm);

}  // namespace trebsweep
