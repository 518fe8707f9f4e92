#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/journal.hpp"
#include "trebsweep/archive/skeleton.hpp"

namespace trebsweep {

/// The results of a tile.
struct TileResults {
  std::uint64_t number;
  Tally tally;
  std::span<const std::byte> values;  ///< of each map as stored, one map after the other
};

/// The results of a tile as bytes. `values` holds the tile's values in each of `maps`, r2 fastest.
std::vector<std::byte> to_bytes(const Tally& tally, std::span<const std::vector<double>> values,
                                const std::vector<MapInfo>& maps);

/// The number of those bytes.
std::uint64_t result_bytes(const Block& block, std::span<const MapInfo> maps);

/// The results of a tile in a record, to whose bytes they refer.
TileResults to_tile_results(const Record& record);

/// Writes an archive in one process, without MPI: the given tiles; cells of others keep the fill
/// values of their maps. Throws std::runtime_error.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> tiles);

/// Writes an archive, each rank the given tiles of its own. The rest is taken from rank 0, but the
/// optima must be the same on all ranks. Throws mpi::RootError if rank 0 cannot create it, and
/// std::runtime_error on a rank that cannot write its tiles. Collective.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> own, MPI_Comm comm);

/// Sizes, bytes.
struct NeededSpace {
  std::uintmax_t archive;   ///< 0 if it is compressed, and its size unknown
  std::uintmax_t journals;  ///< of all ranks
};

/// The space that a sweep needs, a percent too low at most.
NeededSpace needed_space(const Study& study, const Tiling& tiling, std::span<const MapInfo> maps,
                         int compression);

}  // namespace trebsweep
