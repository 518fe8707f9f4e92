#include "trebsweep/archive/skeleton.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

constexpr const char* r1_text = "length of the counterweight's arm";
constexpr const char* r3_text = "length of the sling";
constexpr const char* r2_text = "length of the throwing arm";

/// The names of dimension scales.
using Axes = std::vector<std::string>;

std::vector<hsize_t> extents_of(hid_t file, const Axes& axes) {
  std::vector<hsize_t> extents;
  for (const std::string& axis : axes)
    extents.push_back(hdf5::extents(hdf5::open_dataset(file, axis)).front());
  return extents;
}

/// Describes a dataset over some axes.
void describe(hid_t file, hid_t dataset, const Axes& axes, std::string_view long_name,
              std::string_view units) {
  for (unsigned d = 0; d < axes.size(); ++d)
    check(H5DSattach_scale(dataset, hdf5::open_dataset(file, axes[d]), d), "attach an axis");
  hdf5::write_attribute(dataset, "long_name", std::string(long_name));
  if (!units.empty()) hdf5::write_attribute(dataset, "units", std::string(units));
}

/// A dataset over some axes.
template <class Number>
hdf5::Dataset create(hid_t file, const std::string& name, const Axes& axes,
                     const std::vector<Number>& values, std::string_view long_name,
                     std::string_view units = "") {
  hdf5::Dataset dataset = hdf5::create_dataset(file, name, extents_of(file, axes), values);
  describe(file, dataset, axes, long_name, units);
  return dataset;
}

std::string create_axis(hid_t file, const std::string& name, const std::vector<double>& values,
                        std::string_view long_name, std::string_view units) {
  const hsize_t count = values.size();
  const hdf5::Dataset scale = hdf5::create_dataset(file, name, {&count, 1}, values);
  check(H5DSset_scale(scale, name.c_str()), "create axis " + name);
  describe(file, scale, {}, long_name, units);
  return name;
}

/// A dimension without coordinates, in the form that netCDF-4 gives it.
std::string create_dimension(hid_t file, const std::string& name, hsize_t count) {
  const hdf5::Dataset dataset = hdf5::create_dataset(file, name, H5T_STD_U8LE, {&count, 1});
  const std::string scale =
      fmt::format("This is a netCDF dimension but not a netCDF variable.{:10d}", count);
  check(H5DSset_scale(dataset, scale.c_str()), "create dimension " + name);
  return name;
}

/// The axes of the maps: those of the study, then r1, r3 and r2.
Axes create_axes(hid_t file, const Study& study) {
  Axes axes;
  for (const OuterAxis& axis : study.job().outer_axes) {
    const Key& key = key_of(axis);
    axes.push_back(create_axis(file, dataset_name(axis.name()), axis.values, key.meaning,
                               key.unit.empty() ? "1" : key.unit));
  }
  const auto& [r1, r3, r2] = study.axes();
  axes.push_back(create_axis(file, "r1", r1, r1_text, "m"));
  axes.push_back(create_axis(file, "r3", r3, r3_text, "m"));
  axes.push_back(create_axis(file, "r2", r2, r2_text, "m"));
  return axes;
}

/// The names of a flag field's values 0, 1, ...; empty for other fields.
std::span<const std::string_view> flag_meanings(Field field) {
  if (field == Field::status) return status_names;
  if (field == Field::slack) return slack_names;
  return {};
}

void create_map(hid_t file, const Axes& axes, Field field, const Skeleton& skeleton) {
  const Output& output = skeleton.job().output;
  const std::string name = dataset_name(field), what = "create map " + name;
  const hid_t type = file_type(field, output.storage);
  const double fill = fill_value(field);
  std::vector<hsize_t> chunk(axes.size() - 3, 1);
  chunk.insert(chunk.end(), skeleton.tiling.edge().begin(), skeleton.tiling.edge().end());
  const hdf5::Properties properties(H5Pcreate(H5P_DATASET_CREATE), what);
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), what);
  check(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &fill), what);
  check(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_INCR), what);
  if (output.compression > 0) {
    check(H5Pset_shuffle(properties), what);
    check(H5Pset_deflate(properties, static_cast<unsigned>(output.compression)), what);
  }
  const hdf5::Dataset map =
      hdf5::create_dataset(file, name, type, extents_of(file, axes), properties);
  describe(file, map, axes, info(field).meaning, info(field).units);
  if (field != Field::status && std::ranges::count(output.fields, Field::status) > 0)
    hdf5::write_attribute(map, "ancillary_variables", "status");
  // Flags have no _FillValue, which would make xarray convert them to floats: the flag 0 marks the
  // cells outside the lattice.
  if (!is_flag(field)) return hdf5::write_attribute(map, "_FillValue", type, {&fill, 1});
  const auto meanings = flag_meanings(field);
  std::vector<double> flags(meanings.size());
  std::iota(flags.begin(), flags.end(), 0);
  hdf5::write_attribute(map, "flag_values", type, flags);
  hdf5::write_attribute(map, "flag_meanings", fmt::format("{}", fmt::join(meanings, " ")));
}

/// Creates the datasets of the optima of a study's scenes.
void create_optima(hid_t file, const Axes& outer, const Skeleton& skeleton) {
  const Expression& objective = skeleton.job().optimum.objective;
  const FieldInfo &speed = info(Field::speed), &time = info(Field::release_time);
  const std::array<std::string_view, best_names.size()> units{
      objective.unit, speed.units, "m", "m", "m", time.units, objective.unit};
  const std::array<std::string_view, best_names.size()> texts{
      meaning(objective),
      speed.meaning,
      r1_text,
      r3_text,
      r2_text,
      time.meaning,
      "error of best_value, for its lengths"};
  for (std::size_t d = 0; d < best_names.size(); ++d) {
    std::vector<double> values;
    for (const BestDesign& best : skeleton.optima) values.push_back(to_numbers(best)[d]);
    const hdf5::Dataset dataset =
        create(file, std::string(best_names[d]), outer, values,
               fmt::format("{}, at the optimum of the scene", texts[d]), units[d]);
    hdf5::write_attribute(dataset, "_FillValue", H5T_IEEE_F64LE, {&BestDesign::nan, 1});
  }
}

/// Creates the datasets that tell which cells of the maps hold designs.
void create_lattices(hid_t file, const Axes& outer, const Study& study) {
  const auto& lattices = study.lattices();
  const auto [n1, n3, n2] = study.extent();
  std::vector<unsigned char> has_r1(lattices.size() * n1, 0);
  std::vector<std::uint64_t> rows, of_scene;
  for (std::size_t l = 0; l < lattices.size(); ++l) {
    for (const std::size_t i1 : lattices[l].r1_indices()) has_r1[l * n1 + i1] = 1;
    for (std::size_t i3 = 0; i3 < n3; ++i3) rows.push_back(lattices[l].row_length(i3));
  }
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene)
    of_scene.push_back(study.lattice_of(scene));
  const std::string lattice = create_dimension(file, "lattice", lattices.size());
  create(file, "scene_lattice", outer, of_scene, "number of the lattice of a scene");
  create(file, "lattice_r1", {lattice, "r1"}, has_r1, "1 where a lattice has designs with this r1");
  create(file, "lattice_rows", {lattice, "r3"}, rows,
         "number of designs along r2, the first ones, at each r3 of a lattice");
}

template <class Names>
void create_table(hid_t file, const std::string& name, const Names& columns,
                  const std::vector<std::uint64_t>& values, const std::string& long_name) {
  const std::string column = create_dimension(file, name + "_column", columns.size());
  const hdf5::Dataset table = create(file, name, {"tile", column}, values, long_name);
  hdf5::write_attribute(table, "columns", fmt::format("{}", fmt::join(columns, " ")));
}

void create_tables(hid_t file, const Skeleton& skeleton, const TileTable& table) {
  const Tiling& tiling = skeleton.tiling;
  std::vector<std::uint64_t> blocks;
  for (std::uint64_t t = 0; t < tiling.size(); ++t) {
    const auto [scene, block] = tiling.tile(t);
    blocks.push_back(scene);
    std::ranges::copy(block.first, std::back_inserter(blocks));
    std::ranges::copy(block.count, std::back_inserter(blocks));
  }
  create_dimension(file, "tile", tiling.size());
  create_table(file, "tile_block", block_columns, blocks,
               "scene, first cell and extent of the tile");
  create_table(file, "tile_designs", status_names, table.designs,
               "designs of the tile with each status");
  std::vector<std::string> maps;
  for (const Field field : skeleton.maps()) maps.push_back(dataset_name(field));
  if (maps.empty()) return;
  create_table(file, "tile_checksum", maps, table.checksums,
               "XXH3 checksum of the tile in each map");
}

/// Writes one cell in each of some chunks of all maps.
void write_cells(hid_t file, const Skeleton& skeleton, const TileRange& tiles) {
  if (tiles.first == tiles.end) return;
  const std::string what = "allocate a map";
  const auto extents = map_extents(skeleton.study);
  std::vector<hsize_t> cells;
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t)
    std::ranges::copy(map_block(skeleton.tiling.tile(t), extents).first, std::back_inserter(cells));
  const hsize_t count = tiles.end - tiles.first;
  const hdf5::Dataspace memory(H5Screate_simple(1, &count, nullptr), what);
  for (const Field field : skeleton.maps()) {
    const hdf5::Dataset map = hdf5::open_dataset(file, dataset_name(field));
    const hdf5::Dataspace space(H5Dget_space(map), what);
    check(H5Sselect_elements(space, H5S_SELECT_SET, count, cells.data()), what);
    const std::vector<double> values(count, fill_value(field));
    check(H5Dwrite(map, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
  }
}

}  // namespace

void create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                     const TileTable& table) {
  hdf5::silence();
  const std::string what = "create " + path.string();
  hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), what);
  const Axes axes = create_axes(file, skeleton.study), outer(axes.begin(), axes.end() - 3);
  for (const Field field : skeleton.maps()) create_map(file, axes, field, skeleton);
  if (is_study(skeleton.job())) create_optima(file, outer, skeleton);
  create_lattices(file, outer, skeleton.study);
  create_tables(file, skeleton, table);
  file.close(what);
}

void allocate_chunks(const std::filesystem::path& path, const Skeleton& skeleton) {
  const bool compressed = skeleton.job().output.compression > 0;
  {
    // Without MPI: through it, HDF5 1.10 to 1.14 allocate every chunk of a map that has none, also
    // those without designs; and 1.10.8 hangs when several ranks write compressed chunks that are
    // not allocated, because it takes them for one.
    const std::string what = "open " + path.string();
    hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
    write_cells(file, skeleton, {0, compressed ? skeleton.tiling.size() : 1});
    file.close(what);
  }
  if (compressed) return;
  // The others through MPI, where HDF5 does not fill a chunk before it is written: otherwise one
  // rank would write the whole archive while the others wait.
  hdf5::File file = hdf5::open_parallel(path, MPI_COMM_SELF);
  write_cells(file, skeleton, {1, skeleton.tiling.size()});
  file.close("close " + path.string());
}

void write_attributes(const std::filesystem::path& path, const Job& job,
                      const std::vector<std::string>& history, const Summary& summary) {
  const std::string what = "write " + path.string();
  hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), what);
  const auto write = [&](std::string_view name, const auto& value) {
    hdf5::write_attribute(file, std::string(name), value);
  };
  const Expression& objective = job.optimum.objective;
  constexpr double nan = BestDesign::nan;
  const MeasuredError error = summary.error.value_or(MeasuredError{nan, nan, nan, 0});
  write("format_version", format_version);
  write("Conventions", "CF-1.10");
  write("title", (is_study(job) ? "Trebuchet study " : "Trebuchet sweep ") +
                     std::filesystem::path(job.output.file).stem().string());
  write("source", version_text());
  write("kernel", std::string(instruction_set()));
  write("numerics_version", std::uint64_t{numerics_version});
  write("history", fmt::format("{}", fmt::join(history, "\n")));
  write("job", to_text(job));
  write("scene", scene_text(job));
  write("objective", objective.text);
  write("objective_units", objective.unit);
  write("error_median", error.median);
  write("error_largest", error.largest);
  write("error_at_optimum", error.at_optimum);
  write("error_designs", error.designs);
  write("designs", summary.tally.designs());
  write("steps", summary.tally.steps);
  write("lane_steps", summary.tally.lane_steps);
  write("integration_seconds", summary.tally.integration_seconds);
  write("sweep_seconds", summary.tally.sweep_seconds);
  const auto scene = summary.best();
  const BestNumbers best = to_numbers(scene ? summary.optima[*scene] : BestDesign{});
  for (std::size_t d = 0; d < best.size(); ++d) write(best_names[d], best[d]);
  file.close(what);
}

}  // namespace trebsweep
