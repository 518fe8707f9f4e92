#include "trebsweep/archive/skeleton.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_chunks.hpp"
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

/// Creates the datasets of the optima of a study's scenes.
void create_optima(hid_t file, const std::vector<hdf5::Dataset>& axes, const Study& study) {
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
    const hdf5::Properties creation(H5Pcreate(H5P_DATASET_CREATE), what);
    check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), what);
    check(H5Pset_fill_value(creation, H5T_NATIVE_DOUBLE, &SceneOptimum::nan), what);
    const hdf5::Dataset dataset(
        H5Dcreate2(file, name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT),
        what);
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
  const auto properties =
      map_properties(info, shape.block(skeleton.tiling.edge()), skeleton.compression);
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
  check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), what);
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

/// Progress over all maps, from the progress within one.
ProgressCallback map_progress(const ProgressCallback& progress, std::size_t map, std::size_t maps) {
  return [=](double fraction) {
    return progress((static_cast<double>(map) + fraction) / static_cast<double>(maps));
  };
}

/// Allocates all chunks of a compressed map, or the first chunk of an uncompressed one. Returns
/// false if stopped.
bool allocate_first(hid_t map, const MapInfo& info, const Skeleton& skeleton,
                    const ProgressCallback& progress) {
  const Tiling& tiling = skeleton.tiling;
  const MapShape shape(skeleton.study);
  if (skeleton.compression == 0)
    return allocate_uncompressed(map, info.fill, shape, tiling, {0, 1}, progress);
  const auto properties = map_properties(info, shape.block(tiling.edge()), skeleton.compression);
  return allocate_compressed(map, empty_chunk(properties, info), shape, tiling, progress);
}

/// Creates the file, with all chunks of compressed maps and the first chunk of uncompressed ones.
/// HDF5 1.10 hangs if the first chunk of a compressed map is allocated in parallel; if that of an
/// uncompressed one is, it allocates the chunks without designs as well. Returns nothing if
/// stopped.
std::optional<RunId> create_file(const std::filesystem::path& path, const Skeleton& skeleton,
                                 const ProgressCallback& progress) {
  const std::string what = "create " + path.string();
  const hdf5::Properties creation(H5Pcreate(H5P_FILE_CREATE), what);
  // Freed space is never reused. A compressed chunk moves when it is written, and the index that a
  // killed run leaves may still hold its old address, which must still hold the old chunk.
  check(H5Pset_file_space_strategy(creation, H5F_FSPACE_STRATEGY_NONE, false, 1), what);
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation, H5P_DEFAULT), what);
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);  // writes the signature
  auto axes = create_axes(file, skeleton.study);
  for (std::size_t m = 0; m < skeleton.maps.size(); ++m) {
    const MapInfo& info = skeleton.maps[m];
    const auto map = create_map(file, axes, info, skeleton);
    if (!allocate_first(map, info, skeleton, map_progress(progress, m, skeleton.maps.size())))
      return std::nullopt;
  }
  if (is_study(skeleton.study.job())) create_optima(file, axes, skeleton.study);
  create_tile_datasets(file, skeleton);
  const RunId run_id = write_run_id(file, path);
  write_attributes(file, skeleton.attributes);
  axes.clear();
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), what);
  file.close(what);
  return run_id;
}

/// Allocates the remaining chunks of uncompressed maps. Through the MPI driver, with which HDF5
/// does not fill a chunk that it allocates: otherwise one rank would write the whole archive while
/// the others wait. Returns false if stopped.
bool allocate_rest(const std::filesystem::path& path, const Skeleton& skeleton,
                   const ProgressCallback& progress) {
  hdf5::File file = hdf5::open_parallel(path, MPI_COMM_SELF);
  for (std::size_t m = 0; m < skeleton.maps.size(); ++m) {
    const MapInfo& info = skeleton.maps[m];
    const hdf5::Dataset map = hdf5::open_dataset(file, info.dataset);
    if (!allocate_uncompressed(map, info.fill, MapShape(skeleton.study), skeleton.tiling,
                               {1, skeleton.tiling.size()},
                               map_progress(progress, m, skeleton.maps.size())))
      return false;
  }
  file.close("close " + path.string());
  return true;
}

}  // namespace

std::uintmax_t minimum_size(const Skeleton& skeleton) {
  const Study& study = skeleton.study;
  const MapShape shape(study);
  const auto chunk = shape.block(skeleton.tiling.edge());
  // Bytes per chunk in full nodes of HDF5's B-tree.
  const std::uintmax_t index_entry = 8 * (chunk.size() + 1) + 17;
  // In tile_done, tile_tally and tile_checksum.
  std::uintmax_t bytes_per_tile =
      1 + sizeof(TallyRow) +
      checksum_columns(skeleton.maps, is_study(skeleton.study.job())).size() *
          sizeof(std::uint64_t);
  for (const MapInfo& info : skeleton.maps)
    bytes_per_tile +=
        index_entry + empty_chunk(map_properties(info, chunk, skeleton.compression), info).size();
  std::uintmax_t numbers =
      is_study(skeleton.study.job()) ? study.scenes() * scene_optimum_names.size() : 0;
  for (const hsize_t values : shape.extent()) numbers += values;
  return numbers * sizeof(double) + skeleton.tiling.size() * bytes_per_tile;
}

std::optional<RunId> create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                                     const ProgressCallback& progress) {
  const auto run_id = create_file(path, skeleton, progress);
  const bool complete =
      run_id && (skeleton.compression > 0 || allocate_rest(path, skeleton, progress));
  return complete ? run_id : std::nullopt;
}

}  // namespace trebsweep
