#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/layout.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// What an archive holds except for the results of its tiles.
struct Skeleton {
  const Study& study;
  const Tiling& tiling;
  const std::vector<MapInfo>& maps;
  int compression;  ///< deflate level, 0 for none
  const Attributes& attributes;
  std::span<const BestDesign> optima;  ///< of the scenes
};

/// The rows of tile_designs and tile_checksum, one after the other.
struct TileTable {
  std::vector<std::uint64_t> designs, checksums;
};

/// Creates the file, or replaces it, with everything but the values of the maps, whose cells have
/// their fill values. For one rank. Throws std::runtime_error.
void create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                     const TileTable& table);

/// Allocates the chunks that hold designs, so that several ranks can write them. For one rank.
/// Throws std::runtime_error.
void allocate_chunks(const std::filesystem::path& path, const Skeleton& skeleton);

}  // namespace trebsweep
