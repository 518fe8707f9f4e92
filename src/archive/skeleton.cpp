#include "trebsweep/archive/skeleton.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "trebsweep/archive/empty_chunk.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/summary.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

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

/// Tells how many tiles of a map are done; returns whether to stop.
using MapWatch = std::function<bool(std::uint64_t tiles)>;

/// Writes a cell of the tiles [first, end) of a map, which allocates their chunks, and no others:
/// chunks first allocated in parallel make HDF5 1.10 hang, if filtered, and else are all allocated.
/// Returns false where `stop` asked for it.
bool touch(hid_t dataset, double value, const Tiling& tiling, std::uint64_t first,
           std::uint64_t end, const MapWatch& stop) {
  const std::string what = "allocate a map";
  const hdf5::Dataspace space(H5Dget_space(dataset), what);
  // Many at a time: through MPI, every call of HDF5 1.10 clears a table of all chunks.
  constexpr std::uint64_t most = 4096;
  while (first < end) {
    if (stop(first)) return false;
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

hdf5::Dataset create_map(hid_t file, const std::vector<hdf5::Dataset>& axes, const MapInfo& info,
                         const Skeleton& skeleton) {
  const std::string what = "create map " + info.dataset;
  const auto extent = sizes(skeleton.lattice.extent());
  const hdf5::Dataspace space(H5Screate_simple(3, extent.data(), nullptr), what);
  const auto storage = map_storage(info, skeleton.tiling.edge(), skeleton.compression);
  hdf5::Dataset dataset(H5Dcreate2(file, info.dataset.c_str(), file_type(info.type), space,
                                   H5P_DEFAULT, storage, H5P_DEFAULT),
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
  return dataset;
}

/// Allocates the chunks of a compressed map that hold designs; empty ones, compressed but once.
bool allocate_compressed(hid_t dataset, const MapInfo& info, const Skeleton& skeleton,
                         const MapWatch& stop) {
  const Tiling& tiling = skeleton.tiling;
  const auto storage = map_storage(info, tiling.edge(), skeleton.compression);
  const auto bytes = empty_chunk(storage, info, tiling.edge());
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    if (stop(t)) return false;
    write_chunk(dataset, tiling.tile(t), bytes);
  }
  return true;
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
                          "results of the tile's designs");
  check(H5DSattach_scale(tallies, tile, 0), "create tile_tally");
  check(H5DSattach_scale(tallies, tally, 1), "create tile_tally");
  hdf5::write_attribute(tallies, "columns", fmt::format("{}", fmt::join(tally_columns, " ")));
}

MapWatch map_watch(const Watch& watch, std::size_t map, const Skeleton& skeleton) {
  const auto tiles = static_cast<double>(skeleton.tiling.size());
  const auto maps = static_cast<double>(skeleton.maps.size());
  return [=, before = static_cast<double>(map)](std::uint64_t done) {
    return watch((before + static_cast<double>(done) / tiles) / maps);
  };
}

/// Creates the file, with the chunks of compressed maps and the first one of each other map.
/// Returns the mark of this run, or nothing where it was stopped.
std::optional<RunId> create_file(const std::filesystem::path& path, const Skeleton& skeleton,
                                 const Watch& watch) {
  const std::string what = "create " + path.string();
  const hdf5::Properties creation(H5Pcreate(H5P_FILE_CREATE), what);
  // Space that was freed is never used again. A compressed chunk moves when it is written, and what
  // a killed run leaves may still point to its old place: that must still be a chunk.
  check(H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_NONE, false, 1), what);
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation, H5P_DEFAULT), what);
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);  // its signature
  const auto& values = skeleton.lattice.axes();
  std::vector<hdf5::Dataset> axes;
  axes.push_back(create_axis(file, "r1", "length of the counterweight's arm", values[0]));
  axes.push_back(create_axis(file, "r3", "length of the sling", values[1]));
  axes.push_back(create_axis(file, "r2", "length of the throwing arm", values[2]));
  for (std::size_t m = 0; m < skeleton.maps.size(); ++m) {
    const MapInfo& info = skeleton.maps[m];
    const auto map = create_map(file, axes, info, skeleton);
    const auto stop = map_watch(watch, m, skeleton);
    if (!(skeleton.compression > 0 ? allocate_compressed(map, info, skeleton, stop)
                                   : touch(map, info.fill, skeleton.tiling, 0, 1, stop)))
      return std::nullopt;
  }
  create_tile_datasets(file, skeleton.tiling);
  const RunId mark = write_run_id(file, path);
  write_attributes(file, skeleton.attributes);
  axes.clear();
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);
  file.close(what);
  return mark;
}

/// Allocates the other chunks of maps that are not compressed. Through MPI, with which HDF5 does
/// not fill a chunk first: one rank would else write the whole archive, while the others wait.
bool allocate_plain(const std::filesystem::path& path, const Skeleton& skeleton,
                    const Watch& watch) {
  hdf5::File file = hdf5::open_parallel(path, MPI_COMM_SELF);
  for (std::size_t m = 0; m < skeleton.maps.size(); ++m) {
    const MapInfo& info = skeleton.maps[m];
    const hdf5::Dataset map = hdf5::open_dataset(file, info.dataset);
    if (!touch(map, info.fill, skeleton.tiling, 1, skeleton.tiling.size(),
               map_watch(watch, m, skeleton)))
      return false;
  }
  file.close("close " + path.string());
  return true;
}

}  // namespace

std::uintmax_t size_of(const Skeleton& skeleton) {
  constexpr std::uintmax_t index_entry = 49;  // of a chunk, in full nodes of HDF5's B-tree
  std::uintmax_t tile = 1 + sizeof(TallyRow), axes = 0;
  for (const MapInfo& info : skeleton.maps) {
    const auto storage = map_storage(info, skeleton.tiling.edge(), skeleton.compression);
    tile += index_entry + empty_chunk(storage, info, skeleton.tiling.edge()).size();
  }
  for (const auto& axis : skeleton.lattice.axes()) axes += axis.size() * sizeof(double);
  return axes + skeleton.tiling.size() * tile;
}

std::optional<RunId> create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                                     const Watch& watch) {
  const auto mark = create_file(path, skeleton, watch);
  const bool whole = mark && (skeleton.compression > 0 || allocate_plain(path, skeleton, watch));
  return whole ? mark : std::nullopt;
}

}  // namespace trebsweep
