#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// Everything in the archive of a sweep, complete or partial, except for the values of its maps.
struct ArchiveContents {
  std::string job;     ///< text of the job file
  std::string scene;   ///< scene_text() of the job
  std::string source;  ///< program and version that created the archive
  std::string kernel;  ///< instruction set that computed it
  std::string history;
  std::array<std::vector<double>, 3> axes;  ///< r1, r3, r2, m
  Index3 tile_edge;                         ///< largest extent of a tile, cells
  std::uint64_t tiles = 0;
  std::uint64_t tiles_done = 0;  ///< leading tiles that are marked done
  Tally tally;                   ///< sum over the tiles done
  std::optional<MeasuredError> error;

  bool complete() const { return tiles_done == tiles; }
};

/// Reads an archive in one process, without MPI. Throws std::runtime_error if the file is not an
/// archive, is damaged, lacks a map, or has another format_version; throws std::system_error if
/// that cannot be decided, for example because reading takes more than a minute.
ArchiveContents read_contents(const std::filesystem::path& path);

}  // namespace trebsweep
