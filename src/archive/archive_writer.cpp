#include "trebsweep/archive/archive_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
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

static_assert(std::is_trivially_copyable_v<Tally>);

/// Calls f(m, type, bytes) with the values of a tile in the m-th map, and their type.
template <class F>
void for_each_map(const Skeleton& skeleton, const Record& tile, F f) {
  const std::uint64_t cells = skeleton.tiling.tile(tile.number).block.cells();
  auto rest = tile.results.subspan(sizeof(Tally));
  for (std::size_t m = 0; const Field field : skeleton.maps()) {
    const hid_t type = file_type(field, skeleton.job().output.storage);
    const std::size_t size = cells * H5Tget_size(type);
    f(m++, type, rest.first(size));
    rest = rest.subspan(size);
  }
}

/// The rows of some tiles; those of others are zero.
TileTable table_of(const Skeleton& skeleton, std::span<const Record> tiles) {
  const std::size_t maps = skeleton.maps().size();
  TileTable table{std::vector<std::uint64_t>(skeleton.tiling.size() * status_names.size()),
                  std::vector<std::uint64_t>(skeleton.tiling.size() * maps)};
  for (const Record& tile : tiles) {
    for_each_map(skeleton, tile, [&](std::size_t m, hid_t, std::span<const std::byte> bytes) {
      table.checksums[tile.number * maps + m] = checksum(bytes);
    });
    std::ranges::copy(tally_of(tile).statuses, &table.designs[tile.number * status_names.size()]);
  }
  return table;
}

std::vector<hdf5::Dataset> open_maps(hid_t file, const Skeleton& skeleton) {
  std::vector<hdf5::Dataset> maps;
  for (const Field field : skeleton.maps())
    maps.push_back(hdf5::open_dataset(file, dataset_name(field)));
  return maps;
}

constexpr const char* writing = "write the maps";

void write_tile(const std::vector<hdf5::Dataset>& maps, const Skeleton& skeleton,
                const Record& tile, hid_t transfer) {
  const MapBlock block = map_block(skeleton.tiling.tile(tile.number), map_extents(skeleton.study));
  for_each_map(skeleton, tile, [&](std::size_t m, hid_t type, std::span<const std::byte> bytes) {
    const auto& [file, memory] = hdf5::select(maps[m], block.first, block.count);
    check(H5Dwrite(maps[m], type, memory, file, transfer, bytes.data()), writing);
  });
}

/// Takes part in a collective transfer without a tile.
void write_nothing(const std::vector<hdf5::Dataset>& maps, hid_t transfer) {
  for (const hdf5::Dataset& map : maps) {
    const hdf5::Dataspace none(H5Dget_space(map), writing);
    check(H5Sselect_none(none), writing);
    // A conversion of the type, even of no values, would make the transfer independent.
    const hdf5::Datatype type(H5Dget_type(map), writing);
    check(H5Dwrite(map, type, none, none, transfer, nullptr), writing);
  }
}

/// HDF5 requires collective writes for compressed maps. Below it each rank writes its own chunks.
hdf5::Properties collective_transfer() {
  const std::string what = "set up collective writing";
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), what);
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), what);
  check(H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO), what);
  return transfer;
}

/// Writes the maps of an open file, each rank its tiles.
void write_maps(hid_t file, const Skeleton& skeleton, std::span<const Record> own, MPI_Comm comm) {
  const auto maps = open_maps(file, skeleton);
  if (skeleton.job().output.compression == 0) {
    for (const Record& tile : own) write_tile(maps, skeleton, tile, H5P_DEFAULT);
    return;
  }
  const auto transfer = collective_transfer();
  const auto most = static_cast<std::size_t>(mpi::max(static_cast<double>(own.size()), comm));
  for (std::size_t i = 0; i < most; ++i)
    i < own.size() ? write_tile(maps, skeleton, own[i], transfer) : write_nothing(maps, transfer);
}

}  // namespace

std::vector<std::byte> to_bytes(const Tally& tally, std::vector<std::vector<double>> maps,
                                const Output& output) {
  std::vector<std::byte> bytes(maps.empty() ? sizeof tally
                                            : result_bytes({{}, {1, 1, maps[0].size()}}, output));
  std::memcpy(bytes.data(), &tally, sizeof tally);
  std::size_t end = sizeof tally;
  const auto fields = stored_fields(output);
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const hid_t type = file_type(fields[m], output.storage);
    check(H5Tconvert(H5T_NATIVE_DOUBLE, type, maps[m].size(), maps[m].data(), nullptr, H5P_DEFAULT),
          "convert a map");
    const std::size_t size = maps[m].size() * H5Tget_size(type);
    std::memcpy(&bytes[end], maps[m].data(), size);
    end += size;
  }
  return bytes;
}

std::uint64_t result_bytes(const Block& block, const Output& output) {
  return sizeof(Tally) + bytes_in(block, output);
}

Tally tally_of(const Record& tile) {
  Tally tally;
  std::memcpy(&tally, tile.results.data(), sizeof tally);
  return tally;
}

void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const Record> tiles) {
  create_skeleton(path, skeleton, table_of(skeleton, tiles));
  const std::string what = "write " + path.string();
  hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
  for (const auto maps = open_maps(file, skeleton); const Record& tile : tiles)
    write_tile(maps, skeleton, tile, H5P_DEFAULT);
  file.close(what);
}

void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const Record> own, MPI_Comm comm) {
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
  if (skeleton.maps().empty()) return;
  hdf5::silence();
  // A rank that fails cannot close the file, for which HDF5 needs all ranks: what it throws is not
  // caught, and aborts them.
  hdf5::File file = hdf5::open_parallel(path, comm);
  explain_failure([&] {
    write_maps(file, skeleton, own, comm);
    file.close("write");
  });
}

NeededSpace needed_space(const Study& study, const Tiling& tiling) {
  const Output& output = study.job().output;
  const Block whole{{}, tiling.edge()};  // a chunk is stored whole
  const std::uintmax_t row =
      8 * (block_columns.size() + status_names.size() + stored_fields(output).size());
  const std::uintmax_t scenes = study.scenes();
  NeededSpace needed{0, scenes * (record_header_bytes + sizeof(BestDesign))};
  for (std::uint64_t t = 0; t < tiling.size(); ++t)
    needed.journals += record_header_bytes + result_bytes(tiling.tile(t).block, output);
  if (output.compression == 0) needed.archive = tiling.size() * (bytes_in(whole, output) + row);
  if (is_study(study.job())) needed.archive += scenes * sizeof(BestNumbers);
  return needed;
}

}  // namespace trebsweep
