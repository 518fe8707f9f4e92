#include "trebsweep/archive/verify.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/layout.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

/// Reads a block of a dataset in the type it has in the file, last axis fastest.
std::vector<std::byte> read_block(hid_t dataset, const MapBlock& block) {
  const std::string what = "read a tile";
  const auto& [first, count] = block;
  const hdf5::Datatype type(H5Dget_type(dataset), what);
  const hdf5::Dataspace file(H5Dget_space(dataset), what);
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
        what);
  const hdf5::Dataspace memory(
      H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), what);
  std::vector<std::byte> bytes(static_cast<std::size_t>(H5Sget_simple_extent_npoints(memory)) *
                               H5Tget_size(type));
  check(H5Dread(dataset, type, memory, file, H5P_DEFAULT, bytes.data()), what);
  return bytes;
}

/// Opens a map without a cache of chunks: each is read only once.
hdf5::Dataset open_uncached(hid_t file, const std::string& name) {
  const hdf5::Properties access(H5Pcreate(H5P_DATASET_ACCESS), "open " + name);
  check(H5Pset_chunk_cache(access, 0, 0, 0), "open " + name);
  return {H5Dopen2(file, name.c_str(), access), "open " + name};
}

}  // namespace

std::uint64_t tiles_per_verification(const ArchiveContents& contents) {
  constexpr double bytes_at_once = 1 << 26, most = 4096;
  double cells = 1;
  for (const Tile& tile : contents.tiles)
    cells = std::max(cells, static_cast<double>(tile.block.cells()));
  const double bytes =
      cells * static_cast<double>(contents.checksum_columns.size() * sizeof(double));
  return static_cast<std::uint64_t>(std::clamp(bytes_at_once / bytes, 1.0, most));
}

void verify(const std::filesystem::path& path, const ArchiveContents& contents,
            const TileRange& tiles, std::span<bool> intact) {
  const hdf5::File file = open_archive(path);
  const auto& columns = contents.checksum_columns;
  const auto expected = hdf5::read_numbers<std::uint64_t>(file, "tile_checksum");
  const hdf5::Dataset designs = hdf5::open_dataset(file, "tile_designs");
  std::vector<hdf5::Dataset> maps;
  for (const std::string& column : columns)
    if (is_map(column)) maps.push_back(open_uncached(file, column));
  std::uint64_t row = 0;
  const auto compare = [&](std::uint64_t t, std::size_t column, std::span<const std::byte> bytes) {
    intact[row + column] = checksum(bytes) == expected[t * columns.size() + column];
  };
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t, row += columns.size()) {
    const Tile& tile = contents.tiles[t];
    for (std::size_t m = 0; m < maps.size(); ++m) {
      try {
        compare(t, m, read_block(maps[m], map_block(tile, contents.extents)));
      } catch (const std::runtime_error&) {
        continue;  // damaged so that HDF5 notices it
      }
    }
    compare(t, columns.size() - 1, read_block(designs, {{t, 0}, {1, status_names.size()}}));
    if (!contents.is_study()) continue;
    const bool is_last =
        t + 1 == contents.tiles.size() || contents.tiles[t + 1].scene != tile.scene;
    const BestNumbers best = to_numbers(contents.summary.optima[tile.scene]);
    if (is_last)
      compare(t, maps.size(), std::as_bytes(std::span(best)));
    else
      intact[row + maps.size()] = expected[t * columns.size() + maps.size()] == 0;
  }
}

}  // namespace trebsweep
