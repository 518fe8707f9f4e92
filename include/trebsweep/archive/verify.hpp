#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// A part of a tile whose bytes do not match their checksum, or cannot be read.
struct Damage {
  std::uint64_t tile;
  std::size_t column;  ///< of checksum_columns()
};

/// The number of tiles to verify at once: at most 64 MiB of maps.
std::uint64_t tiles_per_verification(const std::vector<MapInfo>& maps, const Tiling& tiling);

/// Compares the tiles of a study's archive with their checksums, in the order of the tiles. The
/// optimum of a scene belongs to its last tile. Reads the file in a child process: what HDF5 cannot
/// read, or what remains when it crashes or hangs, is damaged. Throws std::system_error if that
/// cannot be decided, as read_contents() does.
std::vector<Damage> find_damage(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                                const Study& study, const Tiling& tiling, const TileRange& tiles);

}  // namespace trebsweep
