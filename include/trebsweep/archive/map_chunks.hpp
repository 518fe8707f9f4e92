#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
#include "trebsweep/archive/progress_callback.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

// The maps are chunked datasets: chunk and tile are the same cells, except that a chunk at the
// upper end of an axis extends beyond its tile. Only chunks that hold designs are allocated.

/// The creation properties of a map's dataset.
hdf5::Properties map_properties(const MapInfo& info, const std::vector<hsize_t>& chunk,
                                int compression);

/// The extent of a chunk, from the creation properties of a map's dataset.
std::vector<hsize_t> chunk_extent(hid_t properties);

/// Writes the chunk whose first cell has an index in the map, given its bytes as stored in the
/// file; the chunk must be allocated. Not collective.
void write_chunk(hid_t map, const std::vector<hsize_t>& first_cell,
                 std::span<const std::byte> bytes);

/// The bytes, as stored in the file, of a chunk in which every cell has the map's fill value.
std::vector<std::byte> empty_chunk(hid_t properties, const MapInfo& info);

/// Allocates the chunks of all tiles of a compressed map, as empty chunks. Returns false if
/// stopped.
bool allocate_compressed(hid_t map, const std::vector<std::byte>& empty, const MapShape& shape,
                         const Tiling& tiling, const ProgressCallback& progress);

/// Allocates the chunks of the given tiles of an uncompressed map, by writing one cell of each.
/// Returns false if stopped.
bool allocate_uncompressed(hid_t map, double fill, const MapShape& shape, const Tiling& tiling,
                           TileRange tiles, const ProgressCallback& progress);

/// Fills the allocated chunks of the uncompressed maps of a file with their fill values, each rank
/// a share of the tiles. Returns false, on all ranks, if any rank was stopped. Collective.
bool fill_uncompressed(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                       const MapShape& shape, const Tiling& tiling,
                       const ProgressCallback& progress, MPI_Comm comm);

/// Throws std::runtime_error if the index of a map's chunks is damaged so that it lacks one of the
/// given tiles. A rank that wrote such a tile would allocate the chunk without the other ranks, and
/// HDF5 would wait forever.
void require_allocated(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                       const MapShape& shape, const Tiling& tiling,
                       const std::vector<TileRange>& tiles);

/// Writes empty chunks for those of the given tiles that are smaller than their chunk, if the map
/// is compressed. HDF5 reads such a chunk before writing a part of it, and a machine that failed
/// may have left arbitrary bytes there.
void reset_edge_chunks(hid_t file, const MapInfo& info, const MapShape& shape, const Tiling& tiling,
                       const std::vector<TileRange>& tiles);

}  // namespace trebsweep
