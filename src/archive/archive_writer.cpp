#include "trebsweep/archive/archive_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <type_traits>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

static_assert(std::endian::native == std::endian::little, "as in the file");
static_assert(std::is_trivially_copyable_v<Tally>);

template <class Number>
void convert(const std::vector<double>& values, std::byte* stored) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = static_cast<Number>(values[i]);
    std::memcpy(stored + i * sizeof number, &number, sizeof number);
  }
}

void convert(MapType type, const std::vector<double>& values, std::byte* stored) {
  switch (type) {
    case MapType::float64:
      return convert<double>(values, stored);
    case MapType::float32:
      return convert<float>(values, stored);
    case MapType::uint8:
      return convert<unsigned char>(values, stored);
  }
}

/// Calls f(m, bytes) with the values of a tile in each map.
template <class F>
void for_each_map(const Skeleton& skeleton, const TileResults& results, F f) {
  const std::uint64_t cells = skeleton.tiling.tile(results.number).block.cells();
  auto rest = results.values;
  for (std::size_t m = 0; m < skeleton.maps.size(); ++m) {
    const std::size_t size = cells * H5Tget_size(file_type(skeleton.maps[m].type));
    f(m, rest.first(size));
    rest = rest.subspan(size);
  }
}

/// The rows of some tiles; those of others are zero.
TileTable table_of(const Skeleton& skeleton, std::span<const TileResults> tiles) {
  const bool has_best = is_study(skeleton.study.job());
  const std::size_t columns = checksum_columns(skeleton.maps, has_best).size();
  TileTable table{std::vector<std::uint64_t>(skeleton.tiling.size() * status_names.size()),
                  std::vector<std::uint64_t>(skeleton.tiling.size() * columns)};
  for (const TileResults& tile : tiles) {
    std::uint64_t* const checksums = &table.checksums[tile.number * columns];
    for_each_map(skeleton, tile, [&](std::size_t m, std::span<const std::byte> bytes) {
      checksums[m] = checksum(bytes);
    });
    const std::uint64_t scene = skeleton.tiling.tile(tile.number).scene;
    if (has_best && tile.number + 1 == skeleton.tiling.of_scene(scene).end) {
      const BestNumbers best = to_numbers(skeleton.optima[scene]);
      checksums[skeleton.maps.size()] = checksum(std::as_bytes(std::span(best)));
    }
    const StatusCounts& designs = tile.tally.statuses;
    checksums[columns - 1] = checksum(std::as_bytes(std::span(designs)));
    std::ranges::copy(designs, &table.designs[tile.number * designs.size()]);
  }
  return table;
}

/// The maps of an open file.
class MapWriter {
 public:
  MapWriter(hid_t file, const Skeleton& skeleton)
      : skeleton_(skeleton), extents_(map_extents(skeleton.study)) {
    for (const MapInfo& map : skeleton.maps) maps_.push_back(hdf5::open_dataset(file, map.dataset));
  }

  /// Writes the values of a tile.
  void write(const TileResults& results, hid_t transfer) const {
    const auto [first, count] = map_block(skeleton_.tiling.tile(results.number), extents_);
    for_each_map(
        skeleton_, results,
        [&, &at = first, &n = count](std::size_t m, std::span<const std::byte> bytes) {
          const hdf5::Dataspace file(H5Dget_space(maps_[m]), what);
          check(H5Sselect_hyperslab(file, H5S_SELECT_SET, at.data(), nullptr, n.data(), nullptr),
                what);
          const hdf5::Dataspace memory(
              H5Screate_simple(static_cast<int>(n.size()), n.data(), nullptr), what);
          check(H5Dwrite(maps_[m], type(m), memory, file, transfer, bytes.data()), what);
        });
  }

  /// Takes part in a collective transfer without a tile.
  void write_nothing(hid_t transfer) const {
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      const hdf5::Dataspace none(H5Dget_space(maps_[m]), what);
      check(H5Sselect_none(none), what);
      check(H5Dwrite(maps_[m], type(m), none, none, transfer, nullptr), what);
    }
  }

 private:
  hid_t type(std::size_t m) const { return file_type(skeleton_.maps[m].type); }

  static constexpr const char* what = "write the maps";
  const Skeleton& skeleton_;
  std::vector<hsize_t> extents_;
  std::vector<hdf5::Dataset> maps_;
};

/// HDF5 requires collective writes for compressed maps. Below it each rank writes its own chunks.
hdf5::Properties collective_transfer() {
  const std::string what = "set up collective writing";
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), what);
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), what);
  check(H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO), what);
  return transfer;
}

/// Writes the maps of an open file, each rank its tiles.
void write_maps(hid_t file, const Skeleton& skeleton, std::span<const TileResults> own,
                MPI_Comm comm) {
  const MapWriter writer(file, skeleton);
  if (skeleton.compression == 0) {
    for (const TileResults& tile : own) writer.write(tile, H5P_DEFAULT);
    return;
  }
  const auto transfer = collective_transfer();
  const auto most = static_cast<std::size_t>(mpi::max(static_cast<double>(own.size()), comm));
  for (std::size_t i = 0; i < most; ++i)
    i < own.size() ? writer.write(own[i], transfer) : writer.write_nothing(transfer);
}

}  // namespace

std::vector<std::byte> to_bytes(const Tally& tally, std::span<const std::vector<double>> values,
                                const std::vector<MapInfo>& maps) {
  std::size_t size = sizeof tally;
  for (std::size_t m = 0; m < maps.size(); ++m)
    size += values[m].size() * H5Tget_size(file_type(maps[m].type));
  std::vector<std::byte> bytes;
  bytes.reserve(size);
  bytes.resize(sizeof tally);
  std::memcpy(bytes.data(), &tally, sizeof tally);
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const std::size_t start = bytes.size();
    bytes.resize(start + values[m].size() * H5Tget_size(file_type(maps[m].type)));
    convert(maps[m].type, values[m], &bytes[start]);
  }
  return bytes;
}

std::uint64_t result_bytes(const Block& block, std::span<const MapInfo> maps) {
  return sizeof(Tally) + bytes_in(block, maps);
}

TileResults to_tile_results(const Record& record) {
  TileResults results{record.number, {}, record.results.subspan(sizeof(Tally))};
  std::memcpy(&results.tally, record.results.data(), sizeof results.tally);
  return results;
}

void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> tiles) {
  create_skeleton(path, skeleton, table_of(skeleton, tiles));
  const std::string what = "write " + path.string();
  hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
  for (const MapWriter writer(file, skeleton); const TileResults& tile : tiles)
    writer.write(tile, H5P_DEFAULT);
  file.close(what);
}

void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> own, MPI_Comm comm) {
  const auto explain_failure = [&](auto write) {
    try {
      write();
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("{} in {}{}; the same command will continue the sweep",
                                           error.what(), path.string(), reached_limit(path)));
    }
  };
  if (mpi::size(comm) == 1)
    return mpi::on_root(comm,
                        [&] { explain_failure([&] { write_archive(path, skeleton, own); }); });
  TileTable table = table_of(skeleton, own);
  mpi::merge(std::span(table.designs), comm);
  mpi::merge(std::span(table.checksums), comm);
  mpi::on_root(comm, [&] {
    explain_failure([&] {
      create_skeleton(path, skeleton, table);
      allocate_chunks(path, skeleton);
    });
  });
  if (skeleton.maps.empty()) return;
  hdf5::silence();
  // A rank that fails cannot close the file, for which HDF5 needs all ranks: what it throws is not
  // caught, and aborts them.
  hdf5::File file = hdf5::open_parallel(path, comm);
  explain_failure([&] {
    write_maps(file, skeleton, own, comm);
    file.close("write");
  });
}

NeededSpace needed_space(const Study& study, const Tiling& tiling, std::span<const MapInfo> maps,
                         int compression) {
  const Block whole{{}, tiling.edge()};  // a chunk is stored whole
  const std::uintmax_t row = 8 * (block_columns.size() + status_names.size() + maps.size() + 1);
  const std::uintmax_t scenes = study.scenes();
  NeededSpace needed{0, scenes * (record_header_bytes + sizeof(BestDesign))};
  for (std::uint64_t t = 0; t < tiling.size(); ++t)
    needed.journals += record_header_bytes + result_bytes(tiling.tile(t).block, maps);
  if (compression == 0) needed.archive = tiling.size() * (bytes_in(whole, maps) + row);
  if (is_study(study.job())) needed.archive += scenes * sizeof(BestNumbers);
  return needed;
}

}  // namespace trebsweep
