#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

// These functions read files of any origin. HDF5 crashes on some damaged files and hangs on others:
// where that matters, call them in a child process first.

/// Opens a file for reading. Throws std::runtime_error.
hdf5::File open_archive(const std::filesystem::path& path);

/// What an archive of any kind and format version has.
struct ArchiveHeader {
  std::string job, source, history;
  std::vector<std::string> tables;  ///< of an assessment, the names of its groups
  bool is_sweep() const { return tables.empty(); }
};

/// Throws std::runtime_error if the file is not an archive or is damaged.
ArchiveHeader read_header(const std::filesystem::path& path);

/// What the archive of a sweep has, except for the values of its maps.
struct ArchiveContents {
  ArchiveHeader header;
  std::string scene;   ///< scene_text() of the job
  std::string kernel;  ///< instruction set that computed it
  Summary summary;
  std::uint64_t tiles_done = 0;
  std::vector<Tile> tiles;
  std::array<std::vector<double>, 3> axes;  ///< r1, r3, r2, m
  std::vector<std::string> maps;            ///< names of their datasets
  std::vector<hsize_t> extents;             ///< of the maps

  std::uint64_t scenes() const { return summary.optima.size(); }
  bool is_study() const { return extents.size() > 3; }
};

/// Throws std::runtime_error if the file is not the archive of a sweep, is damaged, or has another
/// format_version.
ArchiveContents read_contents(const std::filesystem::path& path);

}  // namespace trebsweep
