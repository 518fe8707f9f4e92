#pragma once

#include <filesystem>
#include <vector>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/archive/summary.hpp"

namespace trebsweep {

/// An unfinished sweep in the folder of its journals, as one process reads it.
class Unfinished {
 public:
  /// Throws std::runtime_error if the folder does not hold a sweep that this version can read.
  explicit Unfinished(const std::filesystem::path& folder);

  const PartialSweep& description() const { return description_; }
  const Study& study() const { return study_; }
  const Tiling& tiling() const { return tiling_; }
  std::uint64_t tiles_done() const { return tiles_.size(); }

  /// What is known so far.
  Summary summary() const;

  /// Writes the archive of the tiles that are done, in which the others have the fill values of the
  /// maps. Throws std::runtime_error.
  void write_snapshot(const std::filesystem::path& path) const;

 private:
  PartialSweep description_;
  Study study_;
  Tiling tiling_;
  std::vector<MapInfo> maps_;
  std::vector<MappedFile> journals_;
  std::vector<TileResults> tiles_;
  std::vector<SceneOptimum> optima_;
};

}  // namespace trebsweep
