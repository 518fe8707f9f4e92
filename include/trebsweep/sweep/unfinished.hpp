#pragma once

#include <filesystem>
#include <vector>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/sweep/results.hpp"

namespace trebsweep {

/// An unfinished sweep in the folder of its journals, as one process reads it.
struct Unfinished {
  PartialSweep description;
  Study study;
  Tiling tiling;
  std::vector<MappedFile> journals;
  std::vector<Record> tiles;  ///< that are done
  Summary summary;            ///< what is known so far
};

/// Throws std::runtime_error if the folder does not hold a sweep that this version can read.
Unfinished read_unfinished(const std::filesystem::path& folder);

/// Writes the archive of the tiles that are done, in which the others have the fill values of the
/// maps. Throws std::runtime_error.
void write_snapshot(const std::filesystem::path& path, const Unfinished& sweep);

}  // namespace trebsweep
