#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Everything in the archive of a sweep, complete or partial, except for the values of its maps.
struct ArchiveContents {
  std::string job;     ///< text of the job file
  std::string scene;   ///< scene_text() of the job
  std::string source;  ///< program and version that created the archive
  std::string kernel;  ///< instruction set that computed it
  std::string history;
  LatticeAxes axes;                             ///< r1, r3, r2, m
  std::vector<std::vector<double>> outer_axes;  ///< values of the outer axes of a study
  Index3 tile_edge;                             ///< largest extent of a tile, cells
  std::uint64_t tiles = 0;
  std::uint64_t tiles_done = 0;   ///< leading tiles that are marked done
  std::vector<TallyRow> tallies;  ///< of the tiles done, as stored
  /// Of a study: of each scene, as stored. Valid where the scene's tiles are done.
  std::vector<SceneOptimum> optima;
  std::optional<MeasuredError> error;
  std::optional<RefinedOptimum> refined;  ///< of a sweep of one scene

  bool complete() const { return tiles_done == tiles; }

  /// The sum of the tallies of the tiles done, except those in `without`, which are in ascending
  /// order. Throws std::runtime_error if a tally is impossible.
  Tally tally(std::span<const TileRange> without = {}) const;

  /// The tiles. Throws std::runtime_error if the archive's axes and number of tiles are not those
  /// of the study of its job.
  Tiling tiling(const Study& study) const;
};

/// Reads an archive in one process, without MPI. Throws std::runtime_error if the file is not an
/// archive, is damaged, lacks a map, or has another format_version; throws
/// std::system_error if that cannot be decided, for example because reading takes more than a
/// minute.
ArchiveContents read_contents(const std::filesystem::path& path);

}  // namespace trebsweep
