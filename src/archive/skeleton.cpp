#include "trebsweep/archive/skeleton.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <array>
#include <bit>
#include <numeric>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/tally.hpp"
#include "trebsweep/job/key.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

constexpr const char* r1_text = "length of the counterweight's arm";
constexpr const char* r3_text = "length of the sling";
constexpr const char* r2_text = "length of the throwing arm";

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

hdf5::Dataset create_axis(hid_t file, const std::string& name, const std::string& units,
                          const std::string& long_name, const std::vector<double>& values) {
  const std::string what = "write axis " + name;
  const hsize_t count = values.size();
  const hdf5::Dataspace space(H5Screate_simple(1, &count, nullptr), what);
  hdf5::Dataset axis(
      H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      what);
  check(H5Dwrite(axis, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), what);
  check(H5DSset_scale(axis, name.c_str()), what);
  hdf5::write_attribute(axis, "units", units);
  hdf5::write_attribute(axis, "long_name", long_name);
  return axis;
}

hdf5::Dataset create_axis(hid_t file, const OuterAxis& axis) {
  const Key& key = key_of(axis);
  return create_axis(file, dataset_name(axis.name()), key.unit.empty() ? "1" : key.unit,
                     key.meaning, axis.values);
}

/// The axes of the maps: those of the study, then r1, r3 and r2.
std::vector<hdf5::Dataset> create_axes(hid_t file, const Study& study) {
  std::vector<hdf5::Dataset> axes;
  for (const OuterAxis& axis : study.job().outer_axes) axes.push_back(create_axis(file, axis));
  const auto& [r1, r3, r2] = study.axes();
  axes.push_back(create_axis(file, "r1", "m", r1_text, r1));
  axes.push_back(create_axis(file, "r3", "m", r3_text, r3));
  axes.push_back(create_axis(file, "r2", "m", r2_text, r2));
  return axes;
}

/// Attaches the first axes to the dimensions of a dataset.
void attach_axes(hid_t dataset, const std::vector<hdf5::Dataset>& axes, int rank) {
  for (int d = 0; d < rank; ++d)
    check(H5DSattach_scale(dataset, axes[static_cast<std::size_t>(d)], static_cast<unsigned>(d)),
          "attach an axis");
}

/// Creates the datasets of the optima of a study's scenes, with their values.
void create_optima(hid_t file, const std::vector<hdf5::Dataset>& axes, const Skeleton& skeleton) {
  const Study& study = skeleton.study;
  const FieldInfo& objective = info(study.job().optimum.objective);
  const FieldInfo &speed = info(Field::speed), &time = info(Field::release_time);
  struct Description {
    std::string_view units, text;
  };
  const std::array<Description, scene_optimum_names.size()> descriptions{
      {{objective.units, objective.meaning},
       {speed.units, speed.meaning},
       {"m", r1_text},
       {"m", r3_text},
       {"m", r2_text},
       {time.units, time.meaning},
       {objective.units, "error of best_value, for its lengths"}}};
  const MapShape shape(study);
  const int rank = static_cast<int>(shape.outer().size());
  for (std::size_t d = 0; d < descriptions.size(); ++d) {
    const std::string name(scene_optimum_names[d]), what = "create " + name;
    const hdf5::Dataspace space(H5Screate_simple(rank, shape.outer().data(), nullptr), what);
    const hdf5::Dataset dataset(H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                           H5P_DEFAULT, H5P_DEFAULT),
                                what);
    std::vector<double> values;
    for (const SceneOptimum& optimum : skeleton.optima)
      values.push_back(std::bit_cast<std::array<double, descriptions.size()>>(optimum)[d]);
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), what);
    attach_axes(dataset, axes, rank);
    hdf5::write_attribute(dataset, "long_name",
                          fmt::format("{}, at the optimum of the scene", descriptions[d].text));
    hdf5::write_attribute(dataset, "units", std::string(descriptions[d].units));
    write_fill_attribute(dataset, MapType::float64, SceneOptimum::nan);
  }
}

hdf5::Dataset create_map(hid_t file, const std::vector<hdf5::Dataset>& axes, const MapInfo& info,
                         const Skeleton& skeleton) {
  const std::string what = "create map " + info.dataset;
  const MapShape shape(skeleton.study);
  const auto extent = shape.extent();
  const hdf5::Dataspace space(H5Screate_simple(shape.rank(), extent.data(), nullptr), what);
  const auto chunk = shape.block(skeleton.tiling.edge());
  const hdf5::Properties properties(H5Pcreate(H5P_DATASET_CREATE), what);
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), what);
  check(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &info.fill), what);
  check(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_INCR), what);
  if (skeleton.compression > 0) {
    check(H5Pset_shuffle(properties), what);
    check(H5Pset_deflate(properties, static_cast<unsigned>(skeleton.compression)), what);
  }
  hdf5::Dataset dataset(H5Dcreate2(file, info.dataset.c_str(), file_type(info.type), space,
                                   H5P_DEFAULT, properties, H5P_DEFAULT),
                        what);
  attach_axes(dataset, axes, shape.rank());
  hdf5::write_attribute(dataset, "long_name", info.long_name);
  if (!info.units.empty()) hdf5::write_attribute(dataset, "units", info.units);
  if (!info.ancillary.empty())
    hdf5::write_attribute(dataset, "ancillary_variables", info.ancillary);
  // Flags have no _FillValue, which would make xarray convert them to floats: the flag 0 marks the
  // cells outside the lattice.
  if (info.flag_meanings.empty())
    write_fill_attribute(dataset, info.type, info.fill);
  else
    write_flags(dataset, info.flag_meanings);
  return dataset;
}

/// A dimension without coordinates, in the form that netCDF-4 gives it.
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
  // The ranks write it independently, so that it must be allocated.
  check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), what);
  const unsigned char zero = 0;
  check(H5Pset_fill_value(creation, H5T_NATIVE_UCHAR, &zero), what);
  hdf5::Dataset dataset(
      H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), what);
  hdf5::write_attribute(dataset, "long_name", long_name);
  return dataset;
}

void create_tile_datasets(hid_t file, const Skeleton& skeleton) {
  const Tiling& tiling = skeleton.tiling;
  const hdf5::Dataset tile = create_dimension(file, "tile", tiling.size());
  const hdf5::Dataset tally = create_dimension(file, "tally", tally_columns.size());
  const hdf5::Dataset done = create_tile_dataset(file, "tile_done", H5T_STD_U8LE, {tiling.size()},
                                                 "1 where the tile's designs are done");
  check(H5DSattach_scale(done, tile, 0), "create tile_done");
  const Index3& edge = tiling.edge();
  hdf5::write_attribute(done, "edge_r1", static_cast<unsigned long long>(edge[0]));
  hdf5::write_attribute(done, "edge_r3", static_cast<unsigned long long>(edge[1]));
  hdf5::write_attribute(done, "edge_r2", static_cast<unsigned long long>(edge[2]));
  const hdf5::Dataset tallies =
      create_tile_dataset(file, "tile_tally", H5T_IEEE_F64LE, {tiling.size(), tally_columns.size()},
                          "results of the tile's designs");
  check(H5DSattach_scale(tallies, tile, 0), "create tile_tally");
  check(H5DSattach_scale(tallies, tally, 1), "create tile_tally");
  hdf5::write_attribute(tallies, "columns", fmt::format("{}", fmt::join(tally_columns, " ")));
  const auto columns = checksum_columns(skeleton.maps, is_study(skeleton.study.job()));
  const hdf5::Dataset checksum = create_dimension(file, "checksum", columns.size());
  const hdf5::Dataset checksums = create_tile_dataset(
      file, "tile_checksum", H5T_STD_U64LE, {tiling.size(), columns.size()},
      fmt::format("XXH3 checksums of the tile's values in each map{}, and of "
                  "its row of tile_tally",
                  is_study(skeleton.study.job()) ? ", of the optimum in a scene's last tile" : ""));
  check(H5DSattach_scale(checksums, tile, 0), "create tile_checksum");
  check(H5DSattach_scale(checksums, checksum, 1), "create tile_checksum");
  hdf5::write_attribute(checksums, "columns", fmt::format("{}", fmt::join(columns, " ")));
}

/// Writes one cell in each of some chunks of a map.
void write_cells(hid_t map, double fill, const MapShape& shape, const Tiling& tiling,
                 const TileRange& tiles) {
  if (tiles.first == tiles.end) return;
  const std::string what = "allocate a map";
  const hdf5::Dataspace space(H5Dget_space(map), what);
  std::vector<hsize_t> cells;
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t) {
    const auto cell = shape.first_cell(tiling.tile(t));
    cells.insert(cells.end(), cell.begin(), cell.end());
  }
  const hsize_t count = tiles.end - tiles.first;
  check(H5Sselect_elements(space, H5S_SELECT_SET, count, cells.data()), what);
  const hdf5::Dataspace memory(H5Screate_simple(1, &count, nullptr), what);
  const std::vector<double> values(count, fill);
  check(H5Dwrite(map, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
}

void write_cells(hid_t file, const Skeleton& skeleton, const TileRange& tiles) {
  const MapShape shape(skeleton.study);
  for (const MapInfo& info : skeleton.maps)
    write_cells(hdf5::open_dataset(file, info.dataset), info.fill, shape, skeleton.tiling, tiles);
}

}  // namespace

void create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton) {
  hdf5::silence();
  const std::string what = "create " + path.string();
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), what);
  auto axes = create_axes(file, skeleton.study);
  for (const MapInfo& info : skeleton.maps) create_map(file, axes, info, skeleton);
  if (is_study(skeleton.study.job())) create_optima(file, axes, skeleton);
  create_tile_datasets(file, skeleton);
  write_attributes(file, skeleton.attributes);
  axes.clear();
  file.close(what);
}

void allocate_chunks(const std::filesystem::path& path, const Skeleton& skeleton) {
  {
    // Without MPI: through it, HDF5 1.10 to 1.14 allocate every chunk of a map that has none, also
    // those without designs; and 1.10.8 hangs when several ranks write compressed chunks that are
    // not allocated, because it takes them for one.
    const std::string what = "open " + path.string();
    hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
    write_cells(file, skeleton, {0, skeleton.compression > 0 ? skeleton.tiling.size() : 1});
    file.close(what);
  }
  if (skeleton.compression > 0) return;
  // The others through MPI, where HDF5 does not fill a chunk before it is written: otherwise one
  // rank would write the whole archive while the others wait.
  hdf5::File file = hdf5::open_parallel(path, MPI_COMM_SELF);
  write_cells(file, skeleton, {1, skeleton.tiling.size()});
  file.close("close " + path.string());
}

std::uint64_t bytes_in(const Tile& tile, const std::vector<MapInfo>& maps) {
  std::uint64_t bytes = 0;
  for (const MapInfo& map : maps) bytes += tile.block.cells() * H5Tget_size(file_type(map.type));
  return bytes;
}

NeededSpace needed_space(const Study& study, const Tiling& tiling, const std::vector<MapInfo>& maps,
                         int compression) {
  constexpr std::uintmax_t record_header = 40;
  const Tile whole{0, {{}, tiling.edge()}};  // a chunk is stored whole
  NeededSpace needed{0, 0};
  for (std::uint64_t t = 0; t < tiling.size(); ++t)
    needed.journals += record_header + sizeof(Tally) + bytes_in(tiling.tile(t), maps);
  if (compression == 0) needed.archive = tiling.size() * (bytes_in(whole, maps) + sizeof(TallyRow));
  if (is_study(study.job())) needed.archive += study.scenes() * sizeof(SceneOptimum);
  return needed;
}

}  // namespace trebsweep
