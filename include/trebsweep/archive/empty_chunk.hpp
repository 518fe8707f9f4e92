#pragma once

#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/hdf5.hpp"

namespace trebsweep {

/// How a map's dataset is stored: chunks of a tile's largest extent.
hdf5::Properties map_storage(const MapInfo& info, const Index3& edge, int compression);

/// The bytes of a chunk of fill values as they are in the file, for a dataset stored so.
std::vector<unsigned char> empty_chunk(hid_t storage, const MapInfo& info, const Index3& edge);

/// Writes the bytes of a tile's chunk.
void write_chunk(hid_t dataset, const Tile& tile, const std::vector<unsigned char>& bytes);

}  // namespace trebsweep
