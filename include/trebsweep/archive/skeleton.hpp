#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Everything in an archive except what a tile has: its values in the maps, its tally and its
/// checksums.
struct Skeleton {
  const Study& study;
  const Tiling& tiling;
  const std::vector<MapInfo>& maps;
  int compression;  ///< deflate level, 0 for none
  const Attributes& attributes;
  std::span<const SceneOptimum> optima;  ///< of a study's scenes
};

/// Creates the file, or replaces it. Cells have the fill values of their maps, and no tile is done.
/// For one rank. Throws std::runtime_error.
void create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton);

/// Allocates the chunks that hold designs, so that several ranks can write them. For one rank.
/// Throws std::runtime_error.
void allocate_chunks(const std::filesystem::path& path, const Skeleton& skeleton);

/// Sizes, bytes.
struct NeededSpace {
  std::uintmax_t archive;   ///< 0 if it is compressed, and its size unknown
  std::uintmax_t journals;  ///< of all ranks
};

/// The space that a sweep needs, a percent too low at most.
NeededSpace needed_space(const Study& study, const Tiling& tiling, const std::vector<MapInfo>& maps,
                         int compression);

/// The size of a tile's values in all maps, bytes.
std::uint64_t bytes_in(const Tile& tile, const std::vector<MapInfo>& maps);

}  // namespace trebsweep
