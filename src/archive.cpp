#include "trebsweep/archive.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <numeric>
#include <stdexcept>

#include "trebsweep/mpi.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

hdf5::File open_file(const std::filesystem::path& path, MPI_Comm comm) {
  const std::string what = "open " + path.string();
  const hdf5::Properties access(H5Pcreate(H5P_FILE_ACCESS), what);
  check(H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL), what);
  return {H5Fopen(path.c_str(), H5F_ACC_RDWR, access), what};
}

hdf5::Dataset open_dataset(hid_t file, const std::string& name) {
  const std::string what = "open " + name;
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), what};
}

/// Filtered datasets want collective writes. Each rank's data, whole chunks, go to the file by its
/// own hand all the same: gathered by an aggregator, they take longer, and Open MPI 4.1 has been
/// seen to lose its failures, such as a full disk.
hdf5::Properties collective_transfer() {
  const std::string what = "set up collective writing";
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), what);
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), what);
  check(H5Pset_dxpl_mpio_collective_opt(transfer, H5FD_MPIO_INDIVIDUAL_IO), what);
  return transfer;
}

std::array<hsize_t, 3> sizes(const Index3& index) { return {index[0], index[1], index[2]}; }

hid_t file_type(MapType type) {
  switch (type) {
    case MapType::float64:
      return H5T_IEEE_F64LE;
    case MapType::float32:
      return H5T_IEEE_F32LE;
    case MapType::uint8:
      return H5T_STD_U8LE;
  }
  throw std::logic_error("unknown map type");
}

template <class Number>
void write_numbers(hid_t dataset, hid_t memory_type, hid_t memory, hid_t file, hid_t transfer,
                   const std::vector<double>& values) {
  // Converted here: HDF5 turns a collective write that converts types into an independent one.
  const std::vector<Number> numbers(values.begin(), values.end());
  check(H5Dwrite(dataset, memory_type, memory, file, transfer, numbers.data()), "write a map");
}

/// Writes rows of a dataset of a row per tile, by one rank alone.
void write_rows(hid_t dataset, std::uint64_t first, std::size_t count, std::size_t columns,
                hid_t type, const void* rows) {
  const std::string what = "mark tiles done";
  const hdf5::Dataspace file(H5Dget_space(dataset), what);
  const std::array<hsize_t, 2> start{first, 0}, extent{count, columns};  // or the first of each
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
        what);
  const hsize_t values = count * columns;
  const hdf5::Dataspace memory(H5Screate_simple(1, &values, nullptr), what);
  check(H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, rows), what);
}

void write_flags(hid_t dataset, const std::vector<std::string>& meanings) {
  std::vector<unsigned char> values(meanings.size());
  std::iota(values.begin(), values.end(), static_cast<unsigned char>(0));
  const hsize_t count = values.size();
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), "write flag_values");
  const hdf5::Attribute attribute(
      H5Acreate2(dataset, "flag_values", H5T_STD_U8LE, space, H5P_DEFAULT, H5P_DEFAULT),
      "write flag_values");
  check(H5Awrite(attribute, H5T_NATIVE_UCHAR, values.data()), "write flag_values");
  hdf5::write_attribute(dataset, "flag_meanings", fmt::format("{}", fmt::join(meanings, " ")));
}

void write_fill_attribute(hid_t dataset, MapType type, double fill) {
  const hdf5::Dataspace space(H5Screate(H5S_SCALAR), "write _FillValue");
  const hdf5::Attribute attribute(
      H5Acreate2(dataset, "_FillValue", file_type(type), space, H5P_DEFAULT, H5P_DEFAULT),
      "write _FillValue");
  check(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &fill), "write _FillValue");
}

hdf5::Dataset create_axis(hid_t file, const std::string& name, const std::string& long_name,
                          const std::vector<double>& values) {
  const std::string what = "write axis " + name;
  const hsize_t count = values.size();
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), what);
  hdf5::Dataset axis(
      H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      what);
  check(H5Dwrite(axis, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), what);
  check(H5DSset_scale(axis, name.c_str()), what);
  hdf5::write_attribute(axis, "units", std::string("m"));
  hdf5::write_attribute(axis, "long_name", long_name);
  return axis;
}

/// Writes a cell of the tiles [first, end) of a map, which allocates their chunks, and no others:
/// chunks first allocated in parallel make HDF5 1.10 hang, if filtered, and else are all allocated.
/// Returns false where `stop` asked for it.
bool touch(hid_t dataset, double value, const Tiling& tiling, std::uint64_t first,
           std::uint64_t end, const std::function<bool()>& stop) {
  const std::string what = "allocate a map";
  const hdf5::Dataspace space(H5Dget_space(dataset), what);
  // Many at a time: through MPI, every call of HDF5 1.10 clears a table of all chunks.
  constexpr std::uint64_t most = 4096;
  while (first < end) {
    if (stop()) return false;
    std::vector<std::array<hsize_t, 3>> places;
    for (const std::uint64_t last = std::min(first + most, end); first < last; ++first)
      places.push_back(sizes(tiling.tile(first).first));
    check(H5Sselect_elements(space, H5S_SELECT_SET, places.size(), places.front().data()), what);
    const hsize_t count = places.size();
    const hdf5::Dataspace memory(H5Screate_simple(1, &count, nullptr), what);
    const std::vector<double> values(places.size(), value);
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
  }
  return true;
}

/// The bytes of a chunk of fill values, as they are in a file.
std::vector<unsigned char> fill_chunk(hid_t dataset, const MapInfo& info, const Index3& edge) {
  const std::string what = "make an empty chunk";
  const hdf5::Properties memory_only(H5Pcreate(H5P_FILE_ACCESS), what);
  check(H5Pset_fapl_core(memory_only, 1 << 20, false), what);
  const hdf5::File file(H5Fcreate("chunk", H5F_ACC_TRUNC, H5P_DEFAULT, memory_only), what);
  const hdf5::Properties creation(H5Dget_create_plist(dataset), what);
  const auto extent = sizes(edge);
  const hdf5::Dataspace space(H5Screate_simple(3, extent.data(), nullptr), what);
  const hdf5::Dataset chunk(
      H5Dcreate2(file, "chunk", file_type(info.type), space, H5P_DEFAULT, creation, H5P_DEFAULT),
      what);
  const std::array<hsize_t, 3> first{0, 0, 0}, one{1, 1, 1};
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, one.data(), nullptr),
        what);
  const hdf5::Dataspace memory(H5Screate_simple(3, one.data(), nullptr), what);
  check(H5Dwrite(chunk, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &info.fill), what);
  check(H5Fflush(file, H5F_SCOPE_LOCAL), what);
  hsize_t size = 0;
  check(H5Dget_chunk_storage_size(chunk, first.data(), &size), what);
  std::vector<unsigned char> bytes(size);
  std::uint32_t filters = 0;
  check(H5Dread_chunk(chunk, H5P_DEFAULT, first.data(), &filters, bytes.data()), what);
  return bytes;
}

void write_chunk(hid_t dataset, const Tile& tile, const std::vector<unsigned char>& bytes) {
  const auto first = sizes(tile.first);
  check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, first.data(), bytes.size(), bytes.data()),
        "empty a chunk");
}

/// Allocates the chunks of a compressed map that hold designs; empty ones, compressed but once.
bool allocate_compressed(hid_t dataset, const MapInfo& info, const Tiling& tiling,
                         const std::function<bool()>& stop) {
  const auto bytes = fill_chunk(dataset, info, tiling.edge());
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    if (stop()) return false;
    write_chunk(dataset, tiling.tile(t), bytes);
  }
  return true;
}

/// Takes a file's place on the disk, so that a full one shows at once; where that is quick, as on
/// most of Linux' file systems.
void take_place([[maybe_unused]] const std::filesystem::path& path) {
#ifdef __linux__
  const int file = open(path.c_str(), O_WRONLY);
  const auto size = static_cast<off_t>(std::filesystem::file_size(path));
  const int error = file >= 0 && fallocate(file, 0, 0, size) != 0 ? errno : 0;
  if (file >= 0) close(file);
  if (error == ENOSPC || error == EDQUOT || error == EFBIG)
    throw std::runtime_error(
        fmt::format("cannot take {} bytes for {}: {}", size, path.string(), std::strerror(error)));
#endif
}

/// Allocates the chunks of maps that are not compressed, of which each has its first one already.
/// Through MPI, with which HDF5 does not fill a chunk first: one rank would else write the whole
/// archive once, while the others wait.
bool allocate_plain(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                    const Tiling& tiling, const std::function<bool()>& stop) {
  hdf5::File file = open_file(path, MPI_COMM_SELF);
  for (const MapInfo& map : maps)
    if (!touch(open_dataset(file, map.dataset), map.fill, tiling, 1, tiling.size(), stop))
      return false;
  file.close("close " + path.string());
  take_place(path);
  return true;
}

bool create_map(hid_t file, const std::vector<hdf5::Dataset>& axes, const MapInfo& info,
                const Lattice& lattice, const Tiling& tiling, int compression,
                const std::function<bool()>& stop) {
  const std::string what = "create map " + info.dataset;
  const auto extent = sizes(lattice.extent());
  const auto chunk = sizes(tiling.edge());
  const hdf5::Dataspace space(H5Screate_simple(3, extent.data(), nullptr), what);
  const hdf5::Properties creation(H5Pcreate(H5P_DATASET_CREATE), what);
  check(H5Pset_chunk(creation, 3, chunk.data()), what);
  check(H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &info.fill), what);
  check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_INCR), what);
  if (compression > 0) {
    check(H5Pset_shuffle(creation), what);
    check(H5Pset_deflate(creation, static_cast<unsigned>(compression)), what);
  }
  hdf5::Dataset dataset(H5Dcreate2(file, info.dataset.c_str(), file_type(info.type), space,
                                   H5P_DEFAULT, creation, H5P_DEFAULT),
                        what);
  for (unsigned d = 0; d < 3; ++d) check(H5DSattach_scale(dataset, axes[d], d), what);
  hdf5::write_attribute(dataset, "long_name", info.long_name);
  if (!info.units.empty()) hdf5::write_attribute(dataset, "units", info.units);
  if (!info.ancillary.empty())
    hdf5::write_attribute(dataset, "ancillary_variables", info.ancillary);
  // A _FillValue would make xarray turn the flags into floats; they have a value of their own for
  // it.
  if (info.flag_meanings.empty())
    write_fill_attribute(dataset, info.type, info.fill);
  else
    write_flags(dataset, info.flag_meanings);
  return compression > 0 ? allocate_compressed(dataset, info, tiling, stop)
                         : touch(dataset, info.fill, tiling, 0, 1, stop);
}

/// The dimensions of what is kept for each tile, in netCDF's own form of such without coordinates.
hdf5::Dataset create_dimension(hid_t file, const std::string& name, hsize_t count) {
  const std::string what = "create dimension " + name;
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), what);
  hdf5::Dataset dimension(
      H5Dcreate2(file, name.c_str(), H5T_STD_U8LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      what);
  const std::string scale =
      fmt::format("This is a netCDF dimension but not a netCDF variable.{:10d}", count);
  check(H5DSset_scale(dimension, scale.c_str()), what);
  return dimension;
}

hdf5::Dataset create_tile_dataset(hid_t file, const std::string& name, hid_t type,
                                  const std::vector<hsize_t>& extents,
                                  const std::string& long_name) {
  const std::string what = "create " + name;
  const hdf5::Dataspace space(
      H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), what);
  const hdf5::Properties creation(H5Pcreate(H5P_DATASET_CREATE), what);
  check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), what);
  hdf5::Dataset dataset(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), what);
  hdf5::write_attribute(dataset, "long_name", long_name);
  return dataset;
}

void create_tile_datasets(hid_t file, const Tiling& tiling) {
  const hdf5::Dataset tile = create_dimension(file, "tile", tiling.size());
  const hdf5::Dataset tally = create_dimension(file, "tally", tally_columns.size());
  const hdf5::Dataset done = create_tile_dataset(file, "tile_done", H5T_STD_U8LE, {tiling.size()},
                                                 "1 where the tile's designs are done");
  check(H5DSattach_scale(done, tile, 0), "create tile_done");
  const auto edge = sizes(tiling.edge());
  hdf5::write_attribute(done, "edge_r1", static_cast<unsigned long long>(edge[0]));
  hdf5::write_attribute(done, "edge_r3", static_cast<unsigned long long>(edge[1]));
  hdf5::write_attribute(done, "edge_r2", static_cast<unsigned long long>(edge[2]));
  const hdf5::Dataset tallies =
      create_tile_dataset(file, "tile_tally", H5T_IEEE_F64LE, {tiling.size(), tally_columns.size()},
                          "what the tile's designs came to");
  check(H5DSattach_scale(tallies, tile, 0), "create tile_tally");
  check(H5DSattach_scale(tallies, tally, 1), "create tile_tally");
  hdf5::write_attribute(tallies, "columns", fmt::format("{}", fmt::join(tally_columns, " ")));
}

void write_attributes(hid_t file, const Attributes& attributes) {
  for (const auto& [name, value] : attributes)
    std::visit([&, &key = name](const auto& v) { hdf5::write_attribute(file, key, v); }, value);
}

/// Creates the file that will be the partial one. Returns false where `stop` asked for it.
bool create_skeleton(const std::filesystem::path& path, const Lattice& lattice,
                     const Tiling& tiling, const std::vector<MapInfo>& maps, int compression,
                     const Attributes& attributes, const std::function<bool()>& stop) {
  const std::string what = "create " + path.string();
  const hdf5::Properties creation(H5Pcreate(H5P_FILE_CREATE), what);
  // Space that was freed is never used again. A compressed chunk moves when it is written, and what
  // a killed run leaves may still point to its old place: that must still be a chunk.
  check(H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_NONE, false, 1), what);
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT), what);
  const auto& values = lattice.axes();
  std::vector<hdf5::Dataset> axes;
  axes.push_back(create_axis(file, "r1", "length of the counterweight's arm", values[0]));
  axes.push_back(create_axis(file, "r3", "length of the sling", values[1]));
  axes.push_back(create_axis(file, "r2", "length of the throwing arm", values[2]));
  for (const MapInfo& map : maps)
    if (!create_map(file, axes, map, lattice, tiling, compression, stop)) return false;
  create_tile_datasets(file, tiling);
  write_attributes(file, attributes);
  axes.clear();
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);
  file.close(what);
  return compression > 0 || allocate_plain(path, maps, tiling, stop);
}

/// Empties the compressed chunks at the upper ends of a map that are not done. HDF5 reads those
/// before it writes them, as tiles do not fill them, and a machine that went down may have left
/// anything there.
void renew_edges(hid_t file, const MapInfo& info, const Tiling& tiling, std::uint64_t done) {
  const hdf5::Dataset dataset = open_dataset(file, info.dataset);
  const hdf5::Properties creation(H5Dget_create_plist(dataset), "read a map's form");
  if (H5Pget_nfilters(creation) == 0) return;
  const auto bytes = fill_chunk(dataset, info, tiling.edge());
  for (std::uint64_t t = done; t < tiling.size(); ++t) {
    const Tile tile = tiling.tile(t);
    if (tile.count != tiling.edge()) write_chunk(dataset, tile, bytes);
  }
}

/// What keeps a file from growing, if that can be told.
std::string obstacle(const std::filesystem::path& path) {
  rlimit limit{};
  std::error_code unknown;
  const auto size = std::filesystem::file_size(path, unknown);
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && !unknown && size >= limit.rlim_cur)
    return ", its limit of size (ulimit -f) is reached";
  constexpr std::uintmax_t scarce = 1 << 16;
  const auto space = std::filesystem::space(path, unknown);
  if (!unknown && space.available < scarce) return ", no space is left on its disk";
  return "";
}

/// Runs f, which writes in the file; a failure tells what it means.
template <class F>
void write_in(const std::filesystem::path& path, F f) {
  try {
    f();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format(
        "{} in {}{}; what was marked done is kept there, and the same command will continue it",
        error.what(), path.string(), obstacle(path)));
  }
}

}  // namespace

std::string history_line(const std::string& command, std::uint64_t ranks) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} ranks)", fmt::gmtime(std::time(nullptr)),
                     command, ranks);
}

std::filesystem::path partial_path(const std::filesystem::path& path) {
  return path.string() + ".partial";
}

bool create_partial(const std::filesystem::path& path, const Lattice& lattice, const Tiling& tiling,
                    const std::vector<MapInfo>& maps, int compression, const Attributes& attributes,
                    const std::function<bool()>& stop) {
  hdf5::silence();
  const auto partial = partial_path(path);
  const auto unnamed = partial.string() + ".new";
  std::error_code ignored;
  bool whole = false;
  try {
    whole = create_skeleton(unnamed, lattice, tiling, maps, compression, attributes, stop);
    if (whole) std::filesystem::rename(unnamed, partial);
  } catch (...) {
    std::filesystem::remove(unnamed, ignored);
    throw;
  }
  if (!whole) std::filesystem::remove(unnamed, ignored);
  return whole;
}

void continue_partial(const std::filesystem::path& path, const Tiling& tiling,
                      const std::vector<MapInfo>& maps, std::uint64_t done,
                      const std::string& history_line) {
  hdf5::silence();
  const auto partial = partial_path(path);
  write_in(partial, [&] {
    hdf5::File file(H5Fopen(partial.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
                    "open " + partial.string());
    for (const MapInfo& map : maps) renew_edges(file, map, tiling, done);
    std::string history;
    try {
      history = hdf5::read_text_attribute(file, "history") + "\n";
    } catch (const std::runtime_error&) {
      // A run was killed while it was written: not worth the rest.
    }
    hdf5::write_attribute(file, "history", history + history_line);
    file.close("close the file");
  });
}

void finish(const std::filesystem::path& path) {
  std::filesystem::rename(partial_path(path), path);
}

Archive::Archive(const std::filesystem::path& path, const std::vector<MapInfo>& maps, MPI_Comm comm)
    : path_(path), comm_(comm), collective_(collective_transfer()) {
  hdf5::silence();
  file_.emplace(open_file(partial_path(path), comm));
  for (const MapInfo& map : maps) maps_.push_back({open_dataset(*file_, map.dataset), map.type});
  tile_done_ = open_dataset(*file_, "tile_done");
  tile_tally_ = open_dataset(*file_, "tile_tally");
}

void Archive::write_maps(const std::optional<Tile>& tile,
                         std::span<const std::vector<double>> maps) {
  for (std::size_t m = 0; m < maps_.size(); ++m) {
    const Map& map = maps_[m];
    const hdf5::Dataspace file(H5Dget_space(map.dataset), "write a map");
    // Of the file's shape: HDF5 maps other shapes to chunks value by value.
    const auto extent = sizes(tile ? tile->count : Index3{1, 1, 1});
    const hdf5::Dataspace memory(H5Screate_simple(3, extent.data(), nullptr), "write a map");
    static const std::vector<double> nothing;
    if (tile) {
      const auto first = sizes(tile->first);
      check(
          H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, extent.data(), nullptr),
          "write a map");
    } else {
      check(H5Sselect_none(file), "write a map");
      check(H5Sselect_none(memory), "write a map");
    }
    const std::vector<double>& values = tile ? maps[m] : nothing;
    switch (map.type) {
      case MapType::float64:
        write_numbers<double>(map.dataset, H5T_NATIVE_DOUBLE, memory, file, collective_, values);
        break;
      case MapType::float32:
        write_numbers<float>(map.dataset, H5T_NATIVE_FLOAT, memory, file, collective_, values);
        break;
      case MapType::uint8:
        write_numbers<unsigned char>(map.dataset, H5T_NATIVE_UCHAR, memory, file, collective_,
                                     values);
        break;
    }
  }
}

void Archive::write(const std::optional<Tile>& tile, std::span<const std::vector<double>> maps) {
  write_in(partial_path(path_), [&] { write_maps(tile, maps); });
}

void Archive::mark_done(std::uint64_t first, std::span<const TallyRow> tallies) {
  write_in(partial_path(path_), [&] {
    const bool root = mpi::rank(comm_) == 0;
    if (root)
      write_rows(*tile_tally_, first, tallies.size(), tally_columns.size(), H5T_NATIVE_DOUBLE,
                 tallies.data());
    // Without this flush a killed run leaves tiles marked whose data never reached the disk.
    flush();
    const std::vector<unsigned char> done(tallies.size(), 1);
    if (root) write_rows(*tile_done_, first, done.size(), 1, H5T_NATIVE_UCHAR, done.data());
    flush();
  });
}

void Archive::write(const Attributes& attributes) {
  write_in(partial_path(path_), [&] { write_attributes(*file_, attributes); });
}

void Archive::flush() { check(H5Fflush(*file_, H5F_SCOPE_GLOBAL), "flush what was written"); }

void Archive::close() {
  write_in(partial_path(path_), [&] {
    flush();
    tile_done_.reset();
    tile_tally_.reset();
    maps_.clear();
    file_->close("close the file");
  });
}

}  // namespace trebsweep
