#include "trebsweep/archive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
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

hdf5::Dataset open_dataset(const hdf5::File& file, const std::string& name) {
  const std::string what = "open " + name;
  return {H5Dopen2(file, name.c_str(), H5P_DEFAULT), what};
}

hdf5::Properties collective_transfer() {
  hdf5::Properties transfer(H5Pcreate(H5P_DATASET_XFER), "set up collective writing");
  check(H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE), "set up collective writing");
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

/// Allocates the chunks of a map that hold designs, and no others, by writing a cell of each.
/// Chunks first allocated in parallel make HDF5 1.10 hang, if filtered, and else are all allocated.
void allocate(hid_t dataset, hid_t space, double fill, const Tiling& tiling) {
  const std::string what = "allocate a map";
  const std::array<hsize_t, 3> one{1, 1, 1};
  const hdf5::Dataspace memory(H5Screate_simple(3, one.data(), nullptr), what);
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    const auto first = sizes(tiling.tile(t).first);
    check(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, one.data(), nullptr),
          what);
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &fill), what);
  }
}

void create_map(hid_t file, const std::vector<hdf5::Dataset>& axes, const MapInfo& info,
                const Lattice& lattice, const Tiling& tiling, int compression) {
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
  allocate(dataset, space, info.fill, tiling);
}

void create_tile_done(hid_t file, const Tiling& tiling) {
  const std::string what = "create tile_done";
  const hsize_t count = tiling.size();
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), what);
  const auto create = [&](const char* name) {
    return hdf5::Dataset(
        H5Dcreate2(file, name, H5T_STD_U8LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), what);
  };
  // netCDF's own form of a dimension that has no coordinates.
  const hdf5::Dataset tile = create("tile");
  const std::string scale =
      fmt::format("This is a netCDF dimension but not a netCDF variable.{:10d}", count);
  check(H5DSset_scale(tile, scale.c_str()), what);
  const hdf5::Dataset done = create("tile_done");
  check(H5DSattach_scale(done, tile, 0), what);
  hdf5::write_attribute(done, "long_name", std::string("1 where the tile's designs are done"));
}

/// Creates the file with all that it will ever hold, but for values; by one rank alone, since HDF5
/// would allocate every chunk of a dataset that is created in parallel.
void create_skeleton(const std::filesystem::path& path, const Lattice& lattice,
                     const Tiling& tiling, const std::vector<MapInfo>& maps, int compression) {
  const std::string what = "create " + path.string();
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), what);
  const auto& values = lattice.axes();
  std::vector<hdf5::Dataset> axes;
  axes.push_back(create_axis(file, "r1", "length of the counterweight's arm", values[0]));
  axes.push_back(create_axis(file, "r3", "length of the sling", values[1]));
  axes.push_back(create_axis(file, "r2", "length of the throwing arm", values[2]));
  for (const MapInfo& map : maps) create_map(file, axes, map, lattice, tiling, compression);
  create_tile_done(file, tiling);
  axes.clear();
  file.close(what);
}

}  // namespace

std::filesystem::path Archive::partial_path(const std::filesystem::path& path) {
  return path.string() + ".partial";
}

Archive::Archive(const std::filesystem::path& path, const Lattice& lattice, const Tiling& tiling,
                 const std::vector<MapInfo>& maps, int compression, MPI_Comm comm)
    : path_(path), comm_(comm), collective_(collective_transfer()) {
  hdf5::silence();
  const auto partial = partial_path(path);
  mpi::on_root(comm, [&] {
    create_skeleton(partial, lattice, tiling, maps, compression);
    return std::string();
  });
  file_.emplace(open_file(partial, comm));
  for (const MapInfo& map : maps) maps_.push_back({open_dataset(*file_, map.dataset), map.type});
  tile_done_ = open_dataset(*file_, "tile_done");
}

void Archive::write(const std::optional<Tile>& tile, std::span<const std::vector<double>> maps) {
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

void Archive::mark_done(std::uint64_t first, std::uint64_t count) {
  // Without this flush a killed run leaves tiles marked whose data never reached the disk.
  flush();
  if (mpi::rank(comm_) == 0) {
    const hsize_t start = first, length = count;
    const hdf5::Dataspace file(H5Dget_space(*tile_done_), "mark tiles done");
    check(H5Sselect_hyperslab(file, H5S_SELECT_SET, &start, nullptr, &length, nullptr),
          "mark tiles done");
    const hdf5::Dataspace memory(H5Screate_simple(1, &length, nullptr), "mark tiles done");
    const std::vector<unsigned char> done(count, 1);
    check(H5Dwrite(*tile_done_, H5T_NATIVE_UCHAR, memory, file, H5P_DEFAULT, done.data()),
          "mark tiles done");
  }
  flush();
}

void Archive::flush() { check(H5Fflush(*file_, H5F_SCOPE_GLOBAL), "flush " + path_.string()); }

void Archive::finish() {
  flush();
  tile_done_.reset();
  maps_.clear();
  file_->close("close " + path_.string());
  mpi::on_root(comm_, [&] {
    std::filesystem::rename(partial_path(path_), path_);
    return std::string();
  });
}

std::optional<std::string> archived_job(const std::filesystem::path& path) {
  hdf5::silence();
  if (H5Fis_hdf5(path.c_str()) <= 0) return std::nullopt;
  try {
    const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                          "open " + path.string());
    return hdf5::read_text_attribute(file, "job");
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace trebsweep
