#include "trebsweep/cli/json_summary.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {
namespace {

using Json = nlohmann::ordered_json;

/// The optimum of a scene, with the values of the outer axes; null without one.
Json to_json(const BestDesign& best, std::uint64_t scene, const Job& job) {
  Json json{{"scene", Json::object()}};
  const auto index = outer_index(job, scene);
  for (std::size_t a = 0; const OuterAxis& axis : job.outer_axes)
    json["scene"][axis.name()] = axis.values[index[a++]];
  if (!best.exists()) return json;
  json.update(Json{{"value", shown(job.optimum.objective).sign * best.value},
                   {"r1", best.design.r1},
                   {"r3", best.design.r3},
                   {"r2", best.design.r2},
                   {"speed", best.speed},
                   {"release_time", best.release_time},
                   {"error", best.error}});
  return json;
}

}  // namespace

Json to_json(const Summary& summary, const Job& job) {
  const ShownObjective objective = shown(job.optimum.objective);
  Json json{{"complete", summary.complete},
            {"designs", summary.tally.designs()},
            {"statuses", Json::object()},
            {"objective", objective.text},
            {"sought", fmt::format("{} {}", objective.extreme, objective.text)},
            {"unit", unit_text(job.optimum.objective.unit)},
            {"refined", job.optimum.refine && summary.complete},
            {"optimum", Json()},
            {"error", Json()},
            {"steps", summary.tally.steps},
            {"lane_utilisation", summary.tally.utilisation()},
            {"sweep_seconds", summary.tally.sweep_seconds},
            {"integration_seconds", summary.tally.integration_seconds},
            {"scenes", Json::array()},
            {"job", to_text(job)}};
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.tally.statuses[s] > 0)
      json["statuses"][std::string(status_names[s])] = summary.tally.statuses[s];
  if (const auto best = summary.best())
    json["optimum"] = to_json(summary.optima[*best], *best, job);
  if (const auto& error = summary.error)
    json["error"] = {{"median", error->median},
                     {"largest", error->largest},
                     {"at_optimum", error->at_optimum},
                     {"designs", error->designs}};
  if (is_study(job))
    for (std::uint64_t scene = 0; scene < summary.optima.size(); ++scene)
      json["scenes"].push_back(to_json(summary.optima[scene], scene, job));
  return json;
}

}  // namespace trebsweep
