#pragma once

#include <filesystem>
#include <string>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/sweep/results.hpp"

namespace trebsweep {

/// An unfinished sweep in the folder of its journals, as one process reads it.
class Unfinished {
 public:
  /// Throws std::runtime_error if the folder does not hold a sweep that this version can read.
  explicit Unfinished(const std::filesystem::path& folder);

  const PartialSweep& description() const { return description_; }
  const Study& study() const { return study_; }
  std::uint64_t tiles() const { return tiling_.size(); }
  std::uint64_t tiles_done() const { return tiles_.size(); }

  /// The lines of the runs.
  std::string history() const;

  /// What is known so far.
  Summary summary() const;

  /// Writes the archive of the tiles that are done, in which the others have the fill values of the
  /// maps. Throws std::runtime_error.
  void write_snapshot(const std::filesystem::path& path) const;

 private:
  PartialSweep description_;
  Study study_;
  Tiling tiling_;
  StoredRecords stored_;
  std::vector<TileResults> tiles_;
};

}  // namespace trebsweep
