#include "trebsweep/cli/sweep_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "trebsweep/base/number.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {
namespace {

bool must_be_taut(const Job& job) { return job.output.optimum_filter == OptimumFilter::taut; }

/// Lengths of a lattice's design as they are, refined ones to 0.1 micrometres.
std::string lengths_text(const Design<double>& design, bool refined) {
  const char* const format =
      refined ? "r1 = {:.7f}, r2 = {:.7f}, r3 = {:.7f} m" : "r1 = {}, r2 = {}, r3 = {} m";
  return fmt::format(fmt::runtime(format), design.r1, design.r2, design.r3);
}

std::string optimum_text(const BestDesign& best, std::uint64_t scene, const Job& job,
                         bool refined) {
  const Field objective = job.optimum.objective;
  const std::string place = fmt::format("at {}, released at {:.8g} s",
                                        lengths_text(best.design, refined), best.release_time);
  const std::string unit = unit_text(info(objective).units);
  std::string text =
      objective == Field::speed
          ? fmt::format("{:.8f} m/s {}", best.speed, place)
          : fmt::format("{} {:.10g}{}{} {} with {:.8f} m/s", info(objective).name, best.value,
                        unit.empty() ? "" : " ", unit, place, best.speed);
  if (is_study(job)) text += fmt::format(", where {}", outer_values_text(job, scene));
  if (must_be_taut(job)) text += ", the sling taut";
  const auto& constraints = job.optimum.constraints;
  for (std::size_t c = 0; c < constraints.size(); ++c)
    text += fmt::format("{} {}", c == 0 ? ", subject to" : ",", to_text(constraints[c]));
  if (refined) text += fmt::format(", error {:.1g}", best.error);
  return text;
}

/// Why no design of a summary is the optimum.
std::string reason_for_no_optimum(const Summary& summary, const Job& job) {
  bool released = false;
  for (std::size_t s = 0; s < status_names.size(); ++s)
    released |= has_speed(static_cast<Status>(s)) && summary.tally.statuses[s] > 0;
  if (!released) return "none: nothing was released";
  std::vector<std::string> conditions;
  if (job.optimum.objective != Field::speed)
    conditions.push_back(fmt::format("has a finite {}", info(job.optimum.objective).name));
  if (must_be_taut(job)) conditions.emplace_back("has a taut sling");
  if (!job.optimum.constraints.empty()) conditions.emplace_back("satisfies the constraints");
  return fmt::format("none: no released design {}", fmt::join(conditions, " and "));
}

std::string to_text(const MeasuredError& error, Field objective) {
  std::string text = fmt::format("{:.2g} median, {:.2g} largest of {} designs", error.median,
                                 error.largest, error.designs);
  if (!std::isnan(error.at_optimum))
    text += fmt::format("; {:.2g} at the optimum", error.at_optimum);
  if (objective != Field::speed) text += " (of the speed, m/s)";
  return text;
}

using Row = std::vector<std::string>;

/// The numbers of the scenes with an optimum, the largest value first.
std::vector<std::uint64_t> ranking(const std::vector<BestDesign>& optima) {
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

Row row(const Job& job, std::uint64_t scene, const BestDesign& optimum) {
  Row cells;
  const auto index = outer_index(job, scene);
  for (std::size_t a = 0; a < index.size(); ++a)
    cells.push_back(fmt::format("{}", job.outer_axes[a].values[index[a]]));
  cells.push_back(fmt::format("{:.8g}", optimum.value));
  for (const double length : {optimum.design.r1, optimum.design.r2, optimum.design.r3})
    cells.push_back(fmt::format("{:.7g}", length));
  cells.push_back(std::isnan(optimum.error) ? "-" : fmt::format("{:.1g}", optimum.error));
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

/// Scenes without an optimum are counted, together with those not done unless the sweep is
/// complete.
std::string scene_table(const Summary& summary, const Job& job) {
  constexpr std::size_t all = 20, best = 10;
  const auto scenes = ranking(summary.optima);
  const bool is_long = scenes.size() > all;
  std::string text = fmt::format("scenes    {}", summary.optima.size());
  if (scenes.size() < summary.optima.size())
    text += fmt::format(", {} {}without an optimum", summary.optima.size() - scenes.size(),
                        summary.complete ? "" : "not done or ");
  if (scenes.empty()) return text;
  if (is_long) text += fmt::format("; the {} best, and the worst", best);
  const auto [names, units] = header(job);
  std::vector<Row> rows{names, units};
  for (std::size_t n = 0; n < (is_long ? best : scenes.size()); ++n)
    rows.push_back(row(job, scenes[n], summary.optima[scenes[n]]));
  if (is_long) rows.push_back(row(job, scenes.back(), summary.optima[scenes.back()]));
  return text + aligned(rows);
}

}  // namespace

std::string to_text(const Summary& summary, const Job& job) {
  std::string text = fmt::format("designs   {}\n", summary.tally.designs());
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.tally.statuses[s] > 0)
      text += fmt::format("          {} {}\n", summary.tally.statuses[s], status_names[s]);
  const auto scene = summary.best();
  const bool refined = job.optimum.refine && summary.complete;
  text += fmt::format("{}   {}\n", refined ? "refined" : "optimum",
                      scene ? optimum_text(summary.optima[*scene], *scene, job, refined)
                            : reason_for_no_optimum(summary, job));
  if (is_study(job)) text += scene_table(summary, job) + "\n";
  text +=
      fmt::format("error     {}\n", summary.error ? to_text(*summary.error, job.optimum.objective)
                                                  : std::string("not measured"));
  text += fmt::format("steps     {}, lane utilisation {:.1f} %\n", summary.tally.steps,
                      100 * summary.tally.utilisation());
  return text + fmt::format("seconds   {:.2f} ({:.2f} integrating)", summary.tally.sweep_seconds,
                            summary.tally.integration_seconds);
}

}  // namespace trebsweep
