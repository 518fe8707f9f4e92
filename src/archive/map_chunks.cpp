#include "trebsweep/archive/map_chunks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "trebsweep/archive/untrusted_file.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

double fraction(std::uint64_t done, std::uint64_t total) {
  return static_cast<double>(done) / static_cast<double>(total);
}

/// A map whose chunks are to be filled, with the bytes of an empty one.
struct UnfilledMap {
  hdf5::Dataset map;
  std::vector<std::byte> empty;
};

std::vector<UnfilledMap> unfilled_maps(hid_t file, const std::vector<MapInfo>& maps,
                                       const std::vector<hsize_t>& chunk) {
  std::vector<UnfilledMap> unfilled;
  for (const MapInfo& info : maps)
    if (info.fill != 0)  // space that was allocated but not written reads as 0
      unfilled.push_back({hdf5::open_dataset(file, info.dataset),
                          empty_chunk(map_properties(info, chunk, 0), info)});
  return unfilled;
}

/// Whether HDF5 finds a chunk as it does when writing it. H5Dget_chunk_info_by_coord() finds
/// chunks that are in the wrong place of the index, too.
bool is_allocated(hid_t map, const std::vector<hsize_t>& first_cell) {
  hsize_t size = 0;
  return H5Dget_chunk_storage_size(map, first_cell.data(), &size) >= 0 && size > 0;
}

}  // namespace

hdf5::Properties map_properties(const MapInfo& info, const std::vector<hsize_t>& chunk,
                                int compression) {
  const std::string what = "set up map " + info.dataset;
  hdf5::Properties properties(H5Pcreate(H5P_DATASET_CREATE), what);
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), what);
  check(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &info.fill), what);
  check(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_INCR), what);
  if (compression > 0) {
    check(H5Pset_shuffle(properties), what);
    check(H5Pset_deflate(properties, static_cast<unsigned>(compression)), what);
  }
  return properties;
}

std::vector<hsize_t> chunk_extent(hid_t properties) {
  std::vector<hsize_t> extent(H5S_MAX_RANK);
  const int rank =
      check(H5Pget_chunk(properties, H5S_MAX_RANK, extent.data()), "read the extent of a chunk");
  extent.resize(static_cast<std::size_t>(rank));
  return extent;
}

void write_chunk(hid_t map, const std::vector<hsize_t>& first_cell,
                 std::span<const std::byte> bytes) {
  check(H5Dwrite_chunk(map, H5P_DEFAULT, 0, first_cell.data(), bytes.size(), bytes.data()),
        "write a chunk");
}

std::vector<std::byte> empty_chunk(hid_t properties, const MapInfo& info) {
  // HDF5 itself fills and compresses the chunk, in a file in memory.
  const std::string what = "make an empty chunk";
  const hdf5::Properties in_memory(H5Pcreate(H5P_FILE_ACCESS), what);
  check(H5Pset_fapl_core(in_memory, 1 << 20, false), what);
  const hdf5::File file(H5Fcreate("chunk", H5F_ACC_TRUNC, H5P_DEFAULT, in_memory), what);
  const auto extent = chunk_extent(properties);
  const int rank = static_cast<int>(extent.size());
  const hdf5::Dataspace space(H5Screate_simple(rank, extent.data(), nullptr), what);
  const hdf5::Dataset chunk(
      H5Dcreate2(file, "chunk", file_type(info.type), space, H5P_DEFAULT, properties, H5P_DEFAULT),
      what);
  const std::vector<hsize_t> first(extent.size(), 0), one(extent.size(), 1);
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, one.data(), nullptr),
        what);
  const hdf5::Dataspace memory(H5Screate_simple(rank, one.data(), nullptr), what);
  check(H5Dwrite(chunk, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &info.fill), what);
  check(H5Fflush(file, H5F_SCOPE_LOCAL), what);
  hsize_t size = 0;
  check(H5Dget_chunk_storage_size(chunk, first.data(), &size), what);
  std::vector<std::byte> bytes(size);
  std::uint32_t filters = 0;
  check(H5Dread_chunk(chunk, H5P_DEFAULT, first.data(), &filters, bytes.data()), what);
  return bytes;
}

bool allocate_compressed(hid_t map, const std::vector<std::byte>& empty, const MapShape& shape,
                         const Tiling& tiling, const ProgressCallback& progress) {
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    if (progress(fraction(t, tiling.size()))) return false;
    write_chunk(map, shape.first_cell(tiling.tile(t)), empty);
  }
  return true;
}

bool allocate_uncompressed(hid_t map, double fill, const MapShape& shape, const Tiling& tiling,
                           TileRange tiles, const ProgressCallback& progress) {
  const std::string what = "allocate a map";
  const hdf5::Dataspace space(H5Dget_space(map), what);
  // Many cells per call: with the MPI driver, each H5Dwrite of HDF5 1.10 clears a table of all
  // chunks.
  constexpr std::uint64_t cells_per_call = 4096;
  while (tiles.first < tiles.end) {
    if (progress(fraction(tiles.first, tiling.size()))) return false;
    const hsize_t count = std::min(cells_per_call, tiles.end - tiles.first);
    std::vector<hsize_t> cells;
    for (const std::uint64_t end = tiles.first + count; tiles.first < end; ++tiles.first) {
      const auto cell = shape.first_cell(tiling.tile(tiles.first));
      cells.insert(cells.end(), cell.begin(), cell.end());
    }
    check(H5Sselect_elements(space, H5S_SELECT_SET, count, cells.data()), what);
    const hdf5::Dataspace memory(H5Screate_simple(1, &count, nullptr), what);
    const std::vector<double> values(count, fill);
    check(H5Dwrite(map, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
  }
  return true;
}

bool fill_uncompressed(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                       const MapShape& shape, const Tiling& tiling,
                       const ProgressCallback& progress, MPI_Comm comm) {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  hdf5::File file = hdf5::open_parallel(path, comm);
  auto unfilled = unfilled_maps(file, maps, shape.block(tiling.edge()));
  std::size_t bytes_per_tile = 1;
  for (const UnfilledMap& map : unfilled) bytes_per_tile += map.empty.size();
  constexpr std::uint64_t bytes_per_rank = std::uint64_t{16} << 20;
  const std::uint64_t tiles_per_rank = std::max<std::uint64_t>(1, bytes_per_rank / bytes_per_tile);
  const std::uint64_t tiles = unfilled.empty() ? 0 : tiling.size();
  for (std::uint64_t first = 0; first < tiles; first += tiles_per_rank * ranks) {
    const bool stop = progress(fraction(first, tiles));
    if (mpi::max(stop ? 1 : 0, comm) > 0) return false;
    mpi::on_all(comm, [&] {
      const std::uint64_t begin = first + rank * tiles_per_rank,
                          end = std::min(begin + tiles_per_rank, tiles);
      for (std::uint64_t t = begin; t < end; ++t)
        for (const UnfilledMap& map : unfilled)
          write_chunk(map.map, shape.first_cell(tiling.tile(t)), map.empty);
    });
  }
  unfilled.clear();
  mpi::on_all(comm, [&] { file.close("close " + path.string()); });
  return true;
}

void require_allocated(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                       const MapShape& shape, const Tiling& tiling,
                       const std::vector<TileRange>& tiles) {
  const hdf5::File file = untrusted::open(path);
  for (const MapInfo& info : maps) {
    const hdf5::Dataset map = hdf5::open_dataset(file, info.dataset);
    for (const auto& [first, end] : tiles)
      for (std::uint64_t t = first; t < end; ++t)
        if (!is_allocated(map, shape.first_cell(tiling.tile(t))))
          throw std::runtime_error(fmt::format(
              "{}: damaged: the index of map {} lacks tile {}; it cannot be continued: remove it, "
              "or start again with --overwrite",
              path.string(), info.dataset, t));
  }
}

void reset_edge_chunks(hid_t file, const MapInfo& info, const MapShape& shape, const Tiling& tiling,
                       const std::vector<TileRange>& tiles) {
  const hdf5::Dataset map = hdf5::open_dataset(file, info.dataset);
  const hdf5::Properties properties(H5Dget_create_plist(map), "read a map's properties");
  if (H5Pget_nfilters(properties) == 0) return;
  const auto empty = empty_chunk(properties, info);
  for (const auto& [first, end] : tiles)
    for (std::uint64_t t = first; t < end; ++t) {
      const Tile tile = tiling.tile(t);
      if (tile.block.count != tiling.edge()) write_chunk(map, shape.first_cell(tile), empty);
    }
}

}  // namespace trebsweep
