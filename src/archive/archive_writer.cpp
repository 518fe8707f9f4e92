#include "trebsweep/archive/archive_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
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

/// The maps and the datasets of the tiles in an open file.
class Writer {
 public:
  Writer(hid_t file, const Skeleton& skeleton)
      : skeleton_(skeleton),
        shape_(skeleton.study),
        done_(hdf5::open_dataset(file, "tile_done")),
        tally_(hdf5::open_dataset(file, "tile_tally")),
        checksum_(hdf5::open_dataset(file, "tile_checksum")) {
    for (const MapInfo& map : skeleton.maps) maps_.push_back(hdf5::open_dataset(file, map.dataset));
  }

  /// Writes the values of a tile in all maps. A rank without a tile takes part in a collective
  /// transfer.
  void write_maps(const TileResults* results, hid_t transfer) {
    std::span<const std::byte> rest;
    if (results) rest = results->values;
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      const hid_t type = file_type(skeleton_.maps[m].type);
      const std::string what = "write map " + skeleton_.maps[m].dataset;
      const hdf5::Dataspace file(H5Dget_space(maps_[m]), what);
      const Tile tile =
          results ? skeleton_.tiling.tile(results->number) : Tile{0, {{0, 0, 0}, {1, 1, 1}}};
      const auto first = shape_.first_cell(tile), count = shape_.block(tile.block.count);
      const hdf5::Dataspace memory(H5Screate_simple(shape_.rank(), count.data(), nullptr), what);
      if (results) {
        check(
            H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
            what);
      } else {
        check(H5Sselect_none(file), what);
        check(H5Sselect_none(memory), what);
      }
      check(H5Dwrite(maps_[m], type, memory, file, transfer, rest.data()), what);
      if (results) rest = rest.subspan(tile.block.cells() * H5Tget_size(type));
    }
  }

  /// Writes the rows of a tile: its tally and its checksums.
  void write_rows(const TileResults& results) {
    const TallyRow row = to_row(results.tally);
    std::vector<std::uint64_t> checksums;
    const Tile tile = skeleton_.tiling.tile(results.number);
    auto rest = results.values;
    for (const MapInfo& map : skeleton_.maps) {
      const std::size_t size = tile.block.cells() * H5Tget_size(file_type(map.type));
      checksums.push_back(checksum(rest.first(size)));
      rest = rest.subspan(size);
    }
    if (is_study(skeleton_.study.job())) {
      const bool is_last = results.number + 1 == skeleton_.tiling.of_scene(tile.scene).end;
      checksums.push_back(
          is_last && !skeleton_.optima.empty() ? checksum(skeleton_.optima[tile.scene]) : 0);
    }
    checksums.push_back(checksum(std::as_bytes(std::span(row))));
    const unsigned char done = 1;
    write_row(tally_, results.number, row.size(), H5T_NATIVE_DOUBLE, row.data());
    write_row(checksum_, results.number, checksums.size(), H5T_NATIVE_UINT64, checksums.data());
    write_row(done_, results.number, 1, H5T_NATIVE_UCHAR, &done);
  }

 private:
  static void write_row(hid_t dataset, std::uint64_t row, std::size_t columns, hid_t type,
                        const void* values) {
    const std::string what = "write a tile";
    const hdf5::Dataspace file(H5Dget_space(dataset), what);
    // A dataset of rank 1 uses only the first element of each.
    const std::array<hsize_t, 2> start{row, 0}, extent{1, columns};
    check(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
          what);
    const hdf5::Dataspace memory(H5Screate_simple(1, &extent[1], nullptr), what);
    check(H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, values), what);
  }

  const Skeleton& skeleton_;
  MapShape shape_;
  hdf5::Dataset done_, tally_, checksum_;
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

}  // namespace

std::vector<std::byte> to_bytes(const Tally& tally, std::span<const std::vector<double>> values,
                                const std::vector<MapInfo>& maps) {
  std::size_t end = sizeof tally;
  const auto size = [&](std::size_t m) {
    return values[m].size() * H5Tget_size(file_type(maps[m].type));
  };
  for (std::size_t m = 0; m < maps.size(); ++m) end += size(m);
  std::vector<std::byte> bytes(end);
  std::memcpy(bytes.data(), &tally, sizeof tally);
  for (std::size_t m = maps.size(); m-- > 0;) {
    end -= size(m);
    convert(maps[m].type, values[m], &bytes[end]);
  }
  return bytes;
}

TileResults to_tile_results(const Record& record) {
  TileResults results{record.number, {}, record.results.subspan(sizeof(Tally))};
  std::memcpy(&results.tally, record.results.data(), sizeof results.tally);
  return results;
}

bool fits(const Record& record, const Tile& tile, const std::vector<MapInfo>& maps) {
  return record.results.size() == sizeof(Tally) + bytes_in(tile, maps);
}

void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const TileResults> tiles) {
  create_skeleton(path, skeleton);
  const std::string what = "write " + path.string();
  hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
  std::optional<Writer> writer(std::in_place, file, skeleton);
  for (const TileResults& tile : tiles) {
    writer->write_maps(&tile, H5P_DEFAULT);
    writer->write_rows(tile);
  }
  writer.reset();
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
  const bool alone = mpi::size(comm) == 1;
  mpi::on_root(comm, [&] {
    explain_failure([&] {
      if (alone) return write_archive(path, skeleton, own);
      create_skeleton(path, skeleton);
      allocate_chunks(path, skeleton);
    });
  });
  if (alone) return;
  hdf5::silence();
  hdf5::File file = hdf5::open_parallel(path, comm);
  // A rank that fails cannot close the file, for which HDF5 needs all ranks: what it throws is not
  // caught, and aborts them.
  explain_failure([&] {
    std::optional<Writer> writer(std::in_place, file, skeleton);
    if (skeleton.compression > 0) {
      const auto transfer = collective_transfer();
      const auto most = static_cast<std::size_t>(mpi::max(static_cast<double>(own.size()), comm));
      for (std::size_t i = 0; i < most; ++i)
        writer->write_maps(i < own.size() ? &own[i] : nullptr, transfer);
    }
    for (const TileResults& tile : own) {
      if (skeleton.compression == 0) writer->write_maps(&tile, H5P_DEFAULT);
      writer->write_rows(tile);
    }
    writer.reset();
    file.close("write");
  });
}

}  // namespace trebsweep
