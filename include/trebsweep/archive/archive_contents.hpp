#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Everything in the archive of a sweep except for the values of its maps.
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
  std::uint64_t tiles_done = 0;   ///< fewer in a snapshot of an unfinished sweep
  std::vector<TallyRow> tallies;  ///< of the tiles done, as stored
  /// Of a study: of each scene, as stored. Valid where the scene's tiles are done.
  std::vector<SceneOptimum> optima;
  std::optional<MeasuredError> error;
  std::optional<RefinedOptimum> refined;  ///< of a sweep of one scene

  bool complete() const { return tiles_done == tiles; }

  /// The sum of the tallies of the tiles done. Throws std::runtime_error if a tally is impossible.
  Tally tally() const;

  /// The tiles. Throws std::runtime_error if the archive's axes and number of tiles are not those
  /// of the study of its job.
  Tiling tiling(const Study& study) const;
};

/// Reads an archive. Throws std::runtime_error if the file is not an archive, is damaged, lacks a
/// map, or has another format_version.
ArchiveContents read_contents(const std::filesystem::path& path);

}  // namespace trebsweep
