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

/// What the archive of a sweep, complete or partial, holds, except for the values of its maps.
struct ArchiveContents {
  std::string job;     ///< the text of its job file
  std::string scene;   ///< its scene_text()
  std::string source;  ///< the program that made it
  std::string kernel;  ///< the instruction set it was computed with
  std::string history;
  std::array<std::vector<double>, 3> axes;  ///< r1, r3, r2, m
  Index3 tile_edge;
  std::uint64_t tiles = 0, tiles_done = 0;  ///< those from the first on are done
  Tally tally;                              ///< of what is done

  bool complete() const { return tiles_done == tiles; }
};

/// Reads an archive; for one process, without MPI. Throws std::runtime_error where the file is not
/// an archive, is damaged, lacks a map, or is of another format_version, and std::system_error
/// where that cannot be told, as where reading takes more than a minute.
ArchiveContents read_contents(const std::filesystem::path& path);

/// What an archive of any kind says of itself.
struct ArchiveHeader {
  std::string job;                          ///< the text of its job file
  bool is_sweep;                            ///< else it is an assessment
  std::uint64_t tiles = 0, tiles_done = 0;  ///< of a sweep
  std::string replaces;                     ///< file_identity() of the archive it is to replace

  bool complete() const { return tiles_done == tiles; }
};

/// What a file says of itself, or nothing if it is no archive; for one process. Throws
/// std::system_error as read_contents() does.
std::optional<ArchiveHeader> read_archive_header(const std::filesystem::path& path);

/// An archive that `trebsweep assess` made.
struct AssessmentContents {
  std::string job, source, history;
  std::vector<std::string> tables;  ///< names of its groups
};

/// Reads an assessment. Throws as read_contents() does.
AssessmentContents read_assessment(const std::filesystem::path& path);

}  // namespace trebsweep
