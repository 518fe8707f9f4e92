#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/lattice.hpp"
#include "trebsweep/summary.hpp"

namespace trebsweep {

/// What an archive, complete or partial, holds, but for the values of its maps.
struct Contents {
  std::string job;     ///< the text of its job file
  std::string scene;   ///< its scene_text()
  std::string source;  ///< the program that made it
  std::string kernel;  ///< the instruction set it was computed with
  std::string history;
  std::array<std::vector<double>, 3> axes;  ///< r1, r3, r2, m
  Index3 tile_edge;
  std::uint64_t tiles = 0, tiles_done = 0;  ///< those from the first on are done
  Tally tally;                              ///< of what is done
};

/// Reads an archive; for one process, without MPI. Throws std::runtime_error where the file is
/// none, is damaged, or is of another format_version, and std::system_error where that cannot be
/// told, as where reading takes more than a minute.
Contents read_contents(const std::filesystem::path& path);

/// What made an archive.
struct Archived {
  std::string job;  ///< the text of its job file
  bool is_sweep;    ///< else it is an assessment
};

/// What made an archive, or nothing if the file is none; for one process. Throws std::system_error
/// as read_contents() does.
std::optional<Archived> archived_job(const std::filesystem::path& path);

}  // namespace trebsweep
