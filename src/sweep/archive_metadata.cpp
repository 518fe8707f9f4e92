#include "trebsweep/sweep/archive_metadata.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>

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

/// The results of a sweep.
Attributes result_attributes(const Summary& summary) {
  const Optimum none{{nan, nan, nan}, nan, nan, nan, 0};
  const Optimum optimum =
      summary.refined ? summary.refined->optimum : summary.optimum.value_or(none);
  const MeasuredError error = summary.error.value_or(MeasuredError{nan, nan, nan, 0});
  return {{"best_value", optimum.value},
          {"best_speed", optimum.speed},
          {"best_r1", optimum.design.r1},
          {"best_r3", optimum.design.r3},
          {"best_r2", optimum.design.r2},
          {"best_release_time", optimum.release_time},
          {"refined_error", summary.refined ? summary.refined->error : nan},
          {"error_median", error.median},
          {"error_largest", error.largest},
          {"error_at_optimum", error.at_optimum},
          {"error_designs", static_cast<Count>(error.designs)},
          {"designs", static_cast<Count>(summary.designs())},
          {"steps", static_cast<Count>(summary.steps)},
          {"lane_utilisation", summary.utilisation()},
          {"integration_seconds", summary.integration_seconds},
          {"sweep_seconds", summary.sweep_seconds}};
}

}  // namespace

double fill_value(Field field) { return is_flag(field) ? 0 : nan; }

std::vector<MapInfo> map_infos(const Output& output) {
  const std::vector<Field> fields = stored_fields(output);
  const bool has_status = std::ranges::count(fields, Field::status) > 0;
  std::vector<MapInfo> maps;
  for (const Field field : fields)
    maps.push_back({.dataset = dataset_name(field),
                    .units = std::string(info(field).units),
                    .long_name = std::string(info(field).meaning),
                    .ancillary = has_status && field != Field::status ? "status" : "",
                    .type = map_type(field, output.storage),
                    .fill = fill_value(field),
                    .flag_meanings = flag_meanings(field)});
  return maps;
}

Attributes root_attributes(const Job& job, const std::string& history, const Summary& summary) {
  const FieldInfo& objective = info(job.optimum.objective);
  Attributes all = result_attributes(summary);
  all.insert(all.end(), {{"format_version", format_version},
                         {"Conventions", std::string("CF-1.10")},
                         {"title", (is_study(job) ? "Trebuchet study " : "Trebuchet sweep ") +
                                       std::filesystem::path(job.output.file).stem().string()},
                         {"source", version_text()},
                         {"kernel", std::string(instruction_set())},
                         {"objective", std::string(objective.name)},
                         {"objective_units", std::string(objective.units)},
                         {"scene", scene_text(job)},
                         {"numerics_version", Count{numerics_version}},
                         {"job", to_text(job)},
                         {"history", history}});
  return all;
}

}  // namespace trebsweep
