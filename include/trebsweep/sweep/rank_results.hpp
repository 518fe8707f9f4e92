#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/journal.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/tally.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// What a rank has of a sweep: the results of some tiles and of some scenes. Other ranks have
/// others.
class RankResults {
 public:
  /// Reads the journals in the folder of a sweep, each rank some of them, if earlier runs have
  /// written any; `run` is the number of this run. `start` is MPI_Wtime() at its start. Throws
  /// mpi::RootError. Collective.
  RankResults(const std::filesystem::path& folder, std::size_t run, double start,
              const Study& study, const Tiling& tiling, MPI_Comm comm);

  /// The numbers of the tiles, and of the scenes of a study, that no rank has, when the sweep
  /// starts.
  const std::vector<std::uint64_t>& tiles_to_do() const { return tiles_to_do_; }
  const std::vector<std::uint64_t>& scenes_to_do() const { return scenes_to_do_; }

  /// Adds the results of a tile or a scene. Writes the journal when two seconds have passed since
  /// it was last written, or if there is much to write. Throws std::runtime_error if that fails.
  void add(const Record& record);

  /// Writes the journal, and waits until it is on disk.
  void sync() { journal_.sync(); }

  /// Adds the tallies of all ranks, and the best designs and optima of scenes, which then are the
  /// same on all ranks. Collective.
  void combine_tallies(MPI_Comm comm);
  void combine_best(MPI_Comm comm);
  void combine_optima(MPI_Comm comm);

  Tally& tally() { return tally_; }
  const std::vector<BestCell>& best() const { return best_; }          ///< of each scene
  const std::vector<SceneOptimum>& optima() const { return optima_; }  ///< of a study's scenes

  /// The tiles of this rank, valid until add().
  std::vector<TileResults> tiles();

 private:
  void count(const Record& record);

  const Tiling& tiling_;
  std::vector<MappedFile> journals_;  // of earlier runs
  std::vector<Record> earlier_;       // their records
  Journal journal_;
  double written_;  // when the journal was
  std::vector<std::uint64_t> tiles_to_do_, scenes_to_do_;
  Tally tally_;
  std::vector<BestCell> best_;
  std::vector<SceneOptimum> optima_;
};

}  // namespace trebsweep
