#include "trebsweep/archive/scene_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {
namespace {

using Row = std::vector<std::string>;

/// The numbers of the scenes with an optimum, the largest value first.
std::vector<std::uint64_t> ranking(std::span<const SceneOptimum> optima) {
  std::vector<std::uint64_t> scenes;
  for (std::uint64_t scene = 0; scene < optima.size(); ++scene)
    if (optima[scene].exists()) scenes.push_back(scene);
  std::ranges::stable_sort(scenes, std::greater{},
                           [&](std::uint64_t scene) { return optima[scene].value; });
  return scenes;
}

/// The names of the columns and their units.
std::array<Row, 2> header(const Job& job) {
  Row names, units;
  const auto add = [&](const std::string& name, const std::string& unit) {
    names.push_back(name);
    units.push_back(unit);
  };
  for (const OuterAxis& axis : job.outer_axes) add(axis.name(), key_of(axis).unit);
  const FieldInfo& objective = info(job.optimum.objective);
  add(std::string(objective.name), unit_text(objective.units));
  for (const char* length : {"r1", "r2", "r3"}) add(length, "m");
  add("error", unit_text(objective.units));
  return {names, units};
}

Row row(const Job& job, std::uint64_t scene, const SceneOptimum& optimum) {
  Row cells;
  const auto index = outer_index(job, scene);
  for (std::size_t a = 0; a < index.size(); ++a)
    cells.push_back(fmt::format("{}", job.outer_axes[a].values[index[a]]));
  cells.push_back(fmt::format("{:.8g}", optimum.value));
  for (const double length : {optimum.r1, optimum.r2, optimum.r3})
    cells.push_back(fmt::format("{:.7g}", length));
  cells.push_back(fmt::format("{:.1g}", optimum.error));
  return cells;
}

/// Rows with right-aligned columns, a line for each.
std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size(), 0);
  for (const Row& cells : rows)
    for (std::size_t c = 0; c < cells.size(); ++c) widths[c] = std::max(widths[c], cells[c].size());
  std::string text;
  for (const Row& cells : rows) {
    text += "\n        ";
    for (std::size_t c = 0; c < cells.size(); ++c)
      text += fmt::format("  {:>{}}", cells[c], widths[c]);
  }
  return text;
}

}  // namespace

std::string scene_table(const Job& job, std::span<const SceneOptimum> optima, bool complete) {
  constexpr std::size_t all = 20, best = 10;
  const auto scenes = ranking(optima);
  const bool is_long = scenes.size() > all;
  std::string text = fmt::format("scenes    {}", optima.size());
  if (scenes.size() < optima.size())
    text += fmt::format(", {} {}without an optimum", optima.size() - scenes.size(),
                        complete ? "" : "not done or ");
  if (scenes.empty()) return text;
  if (is_long) text += fmt::format("; the {} best, and the worst", best);
  const auto [names, units] = header(job);
  std::vector<Row> rows{names, units};
  for (std::size_t n = 0; n < (is_long ? best : scenes.size()); ++n)
    rows.push_back(row(job, scenes[n], optima[scenes[n]]));
  if (is_long) rows.push_back(row(job, scenes.back(), optima[scenes.back()]));
  return text + aligned(rows);
}

}  // namespace trebsweep
