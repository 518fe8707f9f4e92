#include "trebsweep/cli/sweep_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "trebsweep/base/number.hpp"
#include "trebsweep/base/text_table.hpp"
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

bool is_speed(const Job& job) { return field_of(job.optimum.objective) == Field::speed; }

std::string optimum_text(const BestDesign& best, std::uint64_t scene, const Job& job,
                         bool refined) {
  const ShownObjective objective = shown(job.optimum.objective);
  const std::string place = fmt::format("at {}, released at {:.8g} s",
                                        lengths_text(best.design, refined), best.release_time);
  const std::string unit = unit_text(job.optimum.objective.unit);
  std::string text = is_speed(job) ? fmt::format("{:.8f} m/s {}", best.speed, place)
                                   : fmt::format("{}{} {:.10g}{}{} {} with {:.8f} m/s",
                                                 objective.sign < 0 ? "least " : "", objective.text,
                                                 objective.sign * best.value,
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
  if (!is_speed(job))
    conditions.push_back(fmt::format("has a finite {}", shown(job.optimum.objective).text));
  if (must_be_taut(job)) conditions.emplace_back("has a taut sling");
  if (!job.optimum.constraints.empty()) conditions.emplace_back("satisfies the constraints");
  return fmt::format("none: no released design {}", fmt::join(conditions, " and "));
}

std::string to_text(const MeasuredError& error, const Job& job) {
  std::string text = fmt::format("{:.2g} median, {:.2g} largest of {} designs", error.median,
                                 error.largest, error.designs);
  if (!std::isnan(error.at_optimum))
    text += fmt::format("; {:.2g} at the optimum", error.at_optimum);
  if (!is_speed(job)) text += " (of the speed, m/s)";
  return text;
}

/// The numbers of the scenes with an optimum, the largest value first.
std::vector<std::uint64_t> ranking(const std::vector<BestDesign>& optima) {
  std::vector<std::uint64_t> scenes;
  for (std::uint64_t scene = 0; scene < optima.size(); ++scene)
    if (optima[scene].exists()) scenes.push_back(scene);
  std::ranges::stable_sort(scenes, std::greater{},
                           [&](std::uint64_t scene) { return optima[scene].value; });
  return scenes;
}

/// The values of the outer axes and the optima of some scenes.
std::vector<TextColumn> columns(const std::vector<BestDesign>& optima, const Job& job,
                                const std::vector<std::uint64_t>& scenes) {
  std::vector<TextColumn> all;
  const auto add = [&](std::string_view name, const std::string& unit, auto cell) {
    TextColumn column{{std::string(name), unit}};
    for (const std::uint64_t scene : scenes) column.cells.push_back(cell(scene));
    all.push_back(std::move(column));
  };
  for (std::size_t a = 0; const OuterAxis& axis : job.outer_axes) {
    add(axis.name(), key_of(axis).unit, [&](std::uint64_t scene) {
      return fmt::format("{}", axis.values[outer_index(job, scene)[a]]);
    });
    ++a;
  }
  const std::string unit = unit_text(job.optimum.objective.unit);
  const ShownObjective objective = shown(job.optimum.objective);
  add(objective.text, unit, [&](std::uint64_t scene) {
    return fmt::format("{:.8g}", objective.sign * optima[scene].value);
  });
  const std::array lengths{std::pair{"r1", &Design<double>::r1},
                           std::pair{"r2", &Design<double>::r2},
                           std::pair{"r3", &Design<double>::r3}};
  for (const auto& length : lengths)
    add(length.first, "m", [&](std::uint64_t scene) {
      return fmt::format("{:.7g}", optima[scene].design.*length.second);
    });
  add("error", unit, [&](std::uint64_t scene) {
    const double error = optima[scene].error;
    return std::isnan(error) ? "-" : fmt::format("{:.1g}", error);
  });
  return all;
}

/// Scenes without an optimum are counted, together with those not done unless the sweep is
/// complete.
std::string scene_table(const Summary& summary, const Job& job) {
  constexpr std::size_t all = 20, best = 10;
  auto scenes = ranking(summary.optima);
  const std::size_t without = summary.optima.size() - scenes.size();
  std::string text = fmt::format("scenes    {}", summary.optima.size());
  if (without > 0)
    text +=
        fmt::format(", {} {}without an optimum", without, summary.complete ? "" : "not done or ");
  if (scenes.empty()) return text;
  if (scenes.size() > all) {
    text += fmt::format("; the {} best, and the worst", best);
    scenes.erase(scenes.begin() + best, scenes.end() - 1);
  }
  for (const std::string& line : aligned(columns(summary.optima, job, scenes)))
    text += "\n          " + line;
  return text;
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
  text += fmt::format("error     {}\n",
                      summary.error ? to_text(*summary.error, job) : std::string("not measured"));
  text += fmt::format("steps     {}, lane utilisation {:.1f} %\n", summary.tally.steps,
                      100 * summary.tally.utilisation());
  return text + fmt::format("seconds   {:.2f} ({:.2f} integrating)", summary.tally.sweep_seconds,
                            summary.tally.integration_seconds);
}

}  // namespace trebsweep
