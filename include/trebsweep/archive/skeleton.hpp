#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/progress_callback.hpp"
#include "trebsweep/archive/run_id.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// An archive before its first design is computed: every dataset and attribute, no results.
struct Skeleton {
  const Study& study;
  const Tiling& tiling;
  const std::vector<MapInfo>& maps;
  int compression;  ///< deflate level, 0 for none
  const Attributes& attributes;
};

/// A lower bound, in bytes, of the size of the file that create_skeleton() creates; less than one
/// percent below that of the final archive if the maps are not compressed.
std::uintmax_t minimum_size(const Skeleton& skeleton);

/// Creates a file with the axes, the maps with all their chunks, the optima of a study's scenes,
/// the attributes, tile_done, tile_tally, tile_checksum and the id of this run. The chunks are
/// empty if compressed, undefined otherwise. Nothing in the file moves later except compressed
/// chunks, so that a killed run leaves it readable. At any time the file is empty or starts with
/// the HDF5 signature. For one rank, because HDF5 allocates every chunk of a dataset that is
/// created in parallel, including those without designs. Returns nothing if stopped. Throws
/// std::runtime_error, for example if the file exists.
std::optional<RunId> create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                                     const ProgressCallback& progress);

}  // namespace trebsweep
