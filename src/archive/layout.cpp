#include "trebsweep/archive/layout.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using Count = unsigned long long;

/// The names of a flag field's values 0, 1, ...; empty for other fields.
std::vector<std::string> flag_meanings(Field field) {
  if (field == Field::status) return {status_names.begin(), status_names.end()};
  if (field == Field::slack) return {slack_names.begin(), slack_names.end()};
  return {};
}

MapType map_type(Field field, Storage storage) {
  if (is_flag(field)) return MapType::uint8;
  return storage == Storage::float32 ? MapType::float32 : MapType::float64;
}

}  // namespace

std::vector<MapInfo> map_infos(const Output& output) {
  const std::vector<Field> fields = stored_fields(output);
  const bool has_status = std::ranges::count(fields, Field::status) > 0;
  std::vector<MapInfo> maps;
  for (const Field field : fields)
    maps.push_back({.dataset = dataset_name(info(field).name),
                    .units = std::string(info(field).units),
                    .long_name = std::string(info(field).meaning),
                    .ancillary = has_status && field != Field::status ? "status" : "",
                    .type = map_type(field, output.storage),
                    .fill = fill_value(field),
                    .flag_meanings = flag_meanings(field)});
  return maps;
}

double fill_value(Field field) { return is_flag(field) ? 0 : nan; }

std::string dataset_name(std::string_view name) {
  std::string dataset(name);
  std::replace(dataset.begin(), dataset.end(), '-', '_');
  return dataset;
}

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

std::uint64_t bytes_in(const Block& block, std::span<const MapInfo> maps) {
  std::uint64_t bytes = 0;
  for (const MapInfo& map : maps) bytes += block.cells() * H5Tget_size(file_type(map.type));
  return bytes;
}

std::vector<std::string> checksum_columns(std::span<const MapInfo> maps, bool is_study) {
  std::vector<std::string> columns;
  for (const MapInfo& map : maps) columns.push_back(map.dataset);
  if (is_study) columns.push_back("best");
  columns.push_back("tile_designs");
  return columns;
}

bool is_map(std::string_view column) { return column != "best" && column != "tile_designs"; }

std::vector<hsize_t> map_extents(const Study& study) {
  std::vector<hsize_t> extents;
  for (const OuterAxis& axis : study.job().outer_axes) extents.push_back(axis.values.size());
  const Index3 box = study.extent();
  extents.insert(extents.end(), box.begin(), box.end());
  return extents;
}

MapBlock map_block(const Tile& tile, std::span<const hsize_t> map_extents) {
  const std::size_t outer = map_extents.size() - 3;
  MapBlock block{std::vector<hsize_t>(outer), std::vector<hsize_t>(outer, 1)};
  std::uint64_t scene = tile.scene;
  for (std::size_t d = outer; d-- > 0; scene /= map_extents[d])
    block.first[d] = scene % map_extents[d];
  const auto& [first, count] = tile.block;
  block.first.insert(block.first.end(), first.begin(), first.end());
  block.count.insert(block.count.end(), count.begin(), count.end());
  return block;
}

Attributes root_attributes(const Job& job, const std::string& history, const Summary& summary) {
  const FieldInfo& objective = info(job.optimum.objective);
  const MeasuredError error = summary.error.value_or(MeasuredError{nan, nan, nan, 0});
  Attributes all{{"format_version", format_version},
                 {"Conventions", std::string("CF-1.10")},
                 {"title", (is_study(job) ? "Trebuchet study " : "Trebuchet sweep ") +
                               std::filesystem::path(job.output.file).stem().string()},
                 {"source", version_text()},
                 {"kernel", std::string(instruction_set())},
                 {"numerics_version", Count{numerics_version}},
                 {"history", history},
                 {"job", to_text(job)},
                 {"scene", scene_text(job)},
                 {"objective", std::string(objective.name)},
                 {"objective_units", std::string(objective.units)},
                 {"error_median", error.median},
                 {"error_largest", error.largest},
                 {"error_at_optimum", error.at_optimum},
                 {"error_designs", Count{error.designs}},
                 {"designs", Count{summary.designs()}},
                 {"steps", Count{summary.steps}},
                 {"lane_utilisation", summary.utilisation},
                 {"integration_seconds", summary.integration_seconds},
                 {"sweep_seconds", summary.sweep_seconds}};
  const auto scene = summary.best();
  const BestNumbers best = to_numbers(scene ? summary.optima[*scene] : BestDesign{});
  for (std::size_t d = 0; d < best.size(); ++d) all.emplace_back(best_names[d], best[d]);
  return all;
}

void write_attributes(hid_t file, const Attributes& attributes) {
  for (const auto& [name, value] : attributes)
    std::visit([&, &key = name](const auto& v) { hdf5::write_attribute(file, key, v); }, value);
}

std::string history_line(const std::string& command, std::uint64_t ranks) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} {})", fmt::gmtime(std::time(nullptr)), command,
                     ranks, ranks == 1 ? "rank" : "ranks");
}

}  // namespace trebsweep
