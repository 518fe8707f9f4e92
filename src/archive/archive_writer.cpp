#include "trebsweep/archive/archive_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/map_chunks.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

/// HDF5 requires collective writes for compressed datasets. Below it each rank writes its own data,
/// whole chunks, independently: collecting them on aggregator ranks takes longer, and Open MPI 4.1
/// does not always report an aggregator's failures, such as a full disk.
hdf5::Properties collective_transfer() {
  const std::string what = "set up collective writing";
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), what);
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), what);
  check(H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO), what);
  return transfer;
}

static_assert(std::endian::native == std::endian::little, "as in the file");

template <class Number>
std::vector<std::byte> converted_to(const std::vector<double>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = static_cast<Number>(values[i]);
    std::memcpy(&bytes[i * sizeof number], &number, sizeof number);
  }
  return bytes;
}

/// Values as in the file. Converted here because HDF5 makes a collective write independent if it
/// has to convert types.
std::vector<std::byte> converted_to(MapType type, const std::vector<double>& values) {
  switch (type) {
    case MapType::float64:
      break;
    case MapType::float32:
      return converted_to<float>(values);
    case MapType::uint8:
      return converted_to<unsigned char>(values);
  }
  throw std::logic_error("not a type to convert to");
}

/// The chunk of a tile of the given extent, from the bytes of the tile's values: the chunk has
/// cells beyond the tile, which no reader sees, at the upper ends of the axes.
std::vector<std::byte> chunk_of(const Index3& tile, const Index3& edge,
                                std::span<const std::byte> bytes) {
  const std::size_t row = bytes.size() / (tile[0] * tile[1]);
  const std::size_t chunk_row = row / tile[2] * edge[2];
  std::vector<std::byte> chunk(edge[0] * edge[1] * chunk_row);
  for (std::size_t i = 0; i < tile[0]; ++i)
    for (std::size_t j = 0; j < tile[1]; ++j)
      std::memcpy(&chunk[(i * edge[1] + j) * chunk_row], &bytes[(i * tile[1] + j) * row], row);
  return chunk;
}

/// Writes rows of a dataset that has one row per tile; called by one rank.
void write_rows(hid_t dataset, std::uint64_t first, std::size_t count, std::size_t columns,
                hid_t type, const void* rows) {
  const std::string what = "mark tiles done";
  const hdf5::Dataspace file(H5Dget_space(dataset), what);
  // A dataset of rank 1 uses only the first element of each.
  const std::array<hsize_t, 2> start{first, 0}, extent{count, columns};
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
        what);
  const hsize_t values = count * columns;
  const hdf5::Dataspace memory(H5Screate_simple(1, &values, nullptr), what);
  check(H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, rows), what);
}

}  // namespace

ArchiveWriter::Map ArchiveWriter::open_map(hid_t file, const MapInfo& info) {
  const std::string what = "read the properties of map " + info.dataset;
  Map map{hdf5::open_dataset(file, info.dataset), info.type, false, {}};
  const hdf5::Properties properties(H5Dget_create_plist(map.dataset), what);
  map.compressed = H5Pget_nfilters(properties) > 0;
  const auto chunk = chunk_extent(properties);
  std::copy(chunk.end() - 3, chunk.end(), map.edge.begin());
  return map;
}

ArchiveWriter::ArchiveWriter(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                             const Study& study, MPI_Comm comm)
    : path_(path), shape_(study), comm_(comm), collective_(collective_transfer()) {
  hdf5::silence();
  file_.emplace(hdf5::open_parallel(partial_path(path), comm));
  for (const MapInfo& map : maps) maps_.push_back(open_map(*file_, map));
  tile_done_ = hdf5::open_dataset(*file_, "tile_done");
  tile_tally_ = hdf5::open_dataset(*file_, "tile_tally");
  tile_checksum_ = hdf5::open_dataset(*file_, "tile_checksum");
}

std::vector<std::uint64_t> ArchiveWriter::write_maps(const std::optional<Tile>& tile,
                                                     std::span<const std::vector<double>> maps) {
  std::vector<std::uint64_t> checksums;
  for (std::size_t m = 0; m < maps_.size(); ++m) {
    const Map& map = maps_[m];
    std::vector<std::byte> converted;
    std::span<const std::byte> bytes;
    if (tile) {
      if (map.type == MapType::float64)
        bytes = std::as_bytes(std::span(maps[m]));
      else
        bytes = converted = converted_to(map.type, maps[m]);
      checksums.push_back(checksum(bytes));
    }
    if (map.compressed)
      write_collectively(map, tile, bytes);
    else if (tile && tile->block.count == map.edge)
      write_chunk(map.dataset, shape_.first_cell(*tile), bytes);
    else if (tile)  // a chunk is written at once, the rows of a part of it would be one by one
      write_chunk(map.dataset, shape_.first_cell(*tile),
                  chunk_of(tile->block.count, map.edge, bytes));
  }
  return checksums;
}

void ArchiveWriter::write_collectively(const Map& map, const std::optional<Tile>& tile,
                                       std::span<const std::byte> bytes) {
  const std::string what = "write a map";
  const hdf5::Dataspace file(H5Dget_space(map.dataset), what);
  // Of the same rank as the file's: otherwise HDF5 maps the selection to chunks value by value.
  const auto extent = shape_.block(tile ? tile->block.count : Index3{1, 1, 1});
  const hdf5::Dataspace memory(H5Screate_simple(shape_.rank(), extent.data(), nullptr), what);
  if (tile) {
    const auto first = shape_.first_cell(*tile);
    check(H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, extent.data(), nullptr),
          what);
  } else {
    check(H5Sselect_none(file), what);
    check(H5Sselect_none(memory), what);
  }
  check(H5Dwrite(map.dataset, file_type(map.type), memory, file, collective_, bytes.data()), what);
}

std::vector<std::uint64_t> ArchiveWriter::write(const std::optional<Tile>& tile,
                                                std::span<const std::vector<double>> maps) {
  std::vector<std::uint64_t> checksums;
  write_partial(partial_path(path_), [&] { checksums = write_maps(tile, maps); });
  return checksums;
}

void ArchiveWriter::write_results(std::uint64_t first, std::span<const TallyRow> tallies,
                                  std::span<const std::uint64_t> checksums) {
  write_rows(*tile_tally_, first, tallies.size(), tally_columns.size(), H5T_NATIVE_DOUBLE,
             tallies.data());
  const std::size_t columns = tallies.empty() ? 0 : checksums.size() / tallies.size();
  std::vector<std::uint64_t> rows;
  for (std::size_t t = 0; t < tallies.size(); ++t) {
    const auto of_tile = checksums.subspan(t * columns, columns);
    rows.insert(rows.end(), of_tile.begin(), of_tile.end());
    rows.push_back(checksum(std::as_bytes(std::span(tallies[t]))));
  }
  write_rows(*tile_checksum_, first, tallies.size(), columns + 1, H5T_NATIVE_UINT64, rows.data());
}

void ArchiveWriter::write_optima(std::uint64_t first_scene, std::span<const SceneOptimum> optima) {
  if (mpi::rank(comm_) == 0)
    write_partial(partial_path(path_),
                  [&] { trebsweep::write_optima(*file_, first_scene, optima); });
}

void ArchiveWriter::checkpoint(std::uint64_t first, std::span<const TallyRow> tallies,
                               std::span<const std::uint64_t> checksums) {
  write_partial(partial_path(path_), [&] {
    const bool root = mpi::rank(comm_) == 0;
    if (root) write_results(first, tallies, checksums);
    // Data, tallies and checksums must be in the file before the marks.
    flush();
    const std::vector<unsigned char> done(tallies.size(), 1);
    if (root) write_rows(*tile_done_, first, done.size(), 1, H5T_NATIVE_UCHAR, done.data());
    flush();
  });
}

void ArchiveWriter::write(const Attributes& attributes) {
  write_partial(partial_path(path_), [&] { write_attributes(*file_, attributes); });
}

void ArchiveWriter::flush() {
  check(H5Fflush(*file_, H5F_SCOPE_GLOBAL), "flush the file");
  MPI_Barrier(comm_);  // the flush ends with an fsync on every rank, which is not a barrier
}

void ArchiveWriter::close() {
  write_partial(partial_path(path_), [&] {
    flush();
    tile_done_.reset();
    tile_tally_.reset();
    tile_checksum_.reset();
    maps_.clear();
    file_->close("close the file");
  });
}

}  // namespace trebsweep
