#pragma once

#include <mpi.h>

#include <filesystem>
#include <vector>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/run_id.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/tally.hpp"
#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/tiling.hpp"
#include "trebsweep/sweep/scene_optima.hpp"

namespace trebsweep {

/// What the rounds of a sweep use.
struct RoundContext {
  const Study& study;
  const Tiling& tiling;
  std::filesystem::path partial;  ///< the partial archive
  RunId run_id;
  double design_seconds;  ///< to integrate a design; 0: unknown
  double start_time;      ///< MPI_Wtime() at the start of the sweep
  ProgressStyle progress;
  const Refine& refine;
  const std::function<bool()>& stop;
  MPI_Comm comm;
};

/// The results of all tiles that are done, on rank 0.
struct SweepResults {
  std::vector<Tally> tallies;        ///< of each scene
  std::vector<SceneOptimum> optima;  ///< of each scene of a study that is done

  /// The tally of all scenes.
  Tally total() const;
};

/// Computes tiles in rounds. Each round ends with a checkpoint: maps, tallies, the optima of the
/// scenes whose last tile it computes, and checksums are written and flushed, then the tiles are
/// marked done and the marks flushed. A killed run therefore loses at most the round in progress.
/// `results` has those of earlier runs, and gains those of this one. Collective; returns false, on
/// all ranks, if any rank was stopped before all tiles were done.
bool run_rounds(const RoundContext& context, std::vector<TileRange> to_compute,
                ArchiveWriter& archive, SweepResults& results);

}  // namespace trebsweep
