#include "trebsweep/archive/verify.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/layout.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

/// Reads a block of a map in the type it has in the file, last axis fastest.
std::vector<std::byte> read_block(hid_t map, const MapBlock& block) {
  const std::string what = "read a tile";
  const hdf5::Datatype type(H5Dget_type(map), what);
  const auto& [file, memory] = hdf5::select(map, block.first, block.count);
  std::vector<std::byte> bytes(static_cast<std::size_t>(H5Sget_simple_extent_npoints(memory)) *
                               H5Tget_size(type));
  check(H5Dread(map, type, memory, file, H5P_DEFAULT, bytes.data()), what);
  return bytes;
}

}  // namespace

std::uint64_t tiles_per_verification(const ArchiveContents& contents) {
  constexpr double bytes_at_once = 1 << 26, most = 4096;
  double cells = 1;
  for (const Tile& tile : contents.tiles)
    cells = std::max(cells, static_cast<double>(tile.block.cells()));
  const double bytes = cells * static_cast<double>(contents.maps.size() * sizeof(double));
  return static_cast<std::uint64_t>(std::clamp(bytes_at_once / bytes, 1.0, most));
}

void verify(const std::filesystem::path& path, const ArchiveContents& contents,
            const TileRange& tiles, std::span<bool> intact) {
  const hdf5::File file = open_archive(path);
  const std::size_t columns = contents.maps.size();
  const auto expected = hdf5::read_numbers<std::uint64_t>(file, "tile_checksum");
  for (std::size_t m = 0; m < columns; ++m) {
    const hdf5::Dataset map = hdf5::open_dataset(file, contents.maps[m]);
    for (std::uint64_t t = tiles.first; t < tiles.end; ++t) {
      try {
        const auto bytes = read_block(map, map_block(contents.tiles[t], contents.extents));
        intact[(t - tiles.first) * columns + m] = checksum(bytes) == expected[t * columns + m];
      } catch (const std::runtime_error&) {
        continue;  // damaged so that HDF5 notices it
      }
    }
  }
}

}  // namespace trebsweep
