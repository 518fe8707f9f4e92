#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/run_id.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Told which share of some work is done, up to 1; returns whether to stop.
using Watch = std::function<bool(double share)>;

/// What an archive has before its first design is computed.
struct Skeleton {
  const Lattice& lattice;
  const Tiling& tiling;
  const std::vector<MapInfo>& maps;
  int compression;
  const Attributes& attributes;
};

/// The least size of the file that create_skeleton() makes, bytes; without compression it is less
/// than a hundredth short of the archive's.
std::uintmax_t size_of(const Skeleton& skeleton);

/// Creates a file with all that an archive will ever hold, except for values: axes, maps with all
/// their chunks, attributes, tile_done and tile_tally, and the mark of this run. Compressed maps
/// are empty, the others undefined. Nothing in it is moved later, so that a killed run leaves it
/// sound. From the first moment it is empty or starts with HDF5's signature. For one rank alone,
/// since HDF5 would allocate every chunk of a dataset that is created in parallel. Returns nothing
/// where it was stopped. Throws std::runtime_error, as where there is a file already.
std::optional<RunId> create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                                     const Watch& watch);

}  // namespace trebsweep
