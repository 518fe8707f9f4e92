#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "trebsweep/sweep/results.hpp"

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

  /// The numbers of the tiles and of the scenes that no rank has, when the sweep starts.
  const std::vector<std::uint64_t>& tiles_to_do() const { return tiles_to_do_; }
  const std::vector<std::uint64_t>& scenes_to_do() const { return scenes_to_do_; }

  /// Adds a record of a tile or a scene. Writes the journal when a second has passed since it
  /// was last written, or if there is much to write. Throws std::runtime_error if that fails.
  void add(std::uint64_t number, std::vector<std::byte> results);

  /// Writes the journal, and waits until it is on disk.
  void sync() { journal_.sync(); }

  /// Adds the tallies of all ranks, and the best designs or the optima of scenes, which then are
  /// the same on all ranks. Collective.
  void combine_tiles(MPI_Comm comm);
  void combine_optima(MPI_Comm comm);

  Totals& totals() { return totals_; }

  /// The tiles of this rank, valid until add().
  std::vector<Record> tiles();

 private:
  const Tiling& tiling_;
  StoredRecords earlier_;  // of earlier runs
  Journal journal_;
  double written_;  // when the journal was
  std::vector<std::uint64_t> tiles_to_do_, scenes_to_do_;
  Totals totals_;
};

}  // namespace trebsweep
