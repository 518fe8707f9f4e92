#pragma once

#include <mpi.h>

#include <functional>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/sweep/rank_results.hpp"
#include "trebsweep/sweep/scene_optima.hpp"

namespace trebsweep {

/// What the work of a sweep needs.
struct WorkContext {
  const Study& study;
  const Tiling& tiling;
  double design_seconds;  ///< to integrate a design; 0: unknown
  double start_time;      ///< MPI_Wtime() at the start of the sweep
  ProgressStyle progress;
  const Refine& refine;
  const std::function<bool()>& stop;
  MPI_Comm comm;
};

/// Computes the tiles that are to be done, which the ranks share out. Collective; returns whether
/// all are done. Throws mpi::RootError if a journal cannot be written.
bool compute_tiles(const WorkContext& context, RankResults& results);

/// Finds the optima of the scenes of a study that are to be done, from the best designs of their
/// lattices, which all ranks must know. Collective; returns whether all are done. Throws as
/// compute_tiles() does, and if `refine` throws.
bool find_scene_optima(const WorkContext& context, RankResults& results);

}  // namespace trebsweep
