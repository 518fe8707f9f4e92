#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/journal.hpp"
#include "trebsweep/archive/skeleton.hpp"
#include "trebsweep/archive/tally.hpp"

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

/// The results of a tile in a record, to whose bytes they refer.
TileResults to_tile_results(const Record& record);

/// Whether the results in a record have the size that those of a tile have.
bool fits(const Record& record, const Tile& tile, const std::vector<MapInfo>& maps);

/// Writes an archive in one process, without MPI: the given tiles; others remain as in
/// create_skeleton(). Throws std::runtime_error.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> tiles);

/// Writes an archive, each rank the given tiles of its own. The attributes are taken from rank 0;
/// the optima must be the same on all ranks. Throws mpi::RootError if rank 0 cannot create it, and
/// std::runtime_error on a rank that cannot write its tiles. Collective.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> own, MPI_Comm comm);

}  // namespace trebsweep
