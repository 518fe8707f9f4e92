#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// What can be read from an archive of any kind and format version.
struct ArchiveHeader {
  std::string job;                          ///< text of the job file
  bool is_sweep;                            ///< otherwise it is an assessment
  std::uint64_t tiles = 0, tiles_done = 0;  ///< of a sweep

  bool complete() const { return tiles_done == tiles; }
};

/// Reads the header of a file; nothing if the file is not an archive.
std::optional<ArchiveHeader> read_archive_header(const std::filesystem::path& path);

}  // namespace trebsweep
