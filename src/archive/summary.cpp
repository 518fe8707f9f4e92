#include "trebsweep/archive/summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <numeric>

#include "trebsweep/archive/scene_table.hpp"
#include "trebsweep/base/number.hpp"

namespace trebsweep {
namespace {

bool must_be_taut(const Job& job) { return job.output.optimum_filter == OptimumFilter::taut; }

/// Lengths of a lattice's design as they are, others to 0.1 micrometres.
std::string to_text(const Design<double>& design, bool in_lattice) {
  const char* const format =
      in_lattice ? "r1 = {}, r2 = {}, r3 = {} m" : "r1 = {:.7f}, r2 = {:.7f}, r3 = {:.7f} m";
  return fmt::format(fmt::runtime(format), design.r1, design.r2, design.r3);
}

std::string to_text(const Optimum& optimum, const Job& job, bool in_lattice) {
  const Field objective = job.optimum.objective;
  const auto& [design, value, speed, release_time, scene] = optimum;
  const std::string place =
      fmt::format("at {}, released at {:.8g} s", to_text(design, in_lattice), release_time);
  const std::string unit = unit_text(info(objective).units);
  std::string text = objective == Field::speed
                         ? fmt::format("{:.8f} m/s {}", speed, place)
                         : fmt::format("{} {:.10g}{}{} {} with {:.8f} m/s", info(objective).name,
                                       value, unit.empty() ? "" : " ", unit, place, speed);
  if (is_study(job)) text += fmt::format(", where {}", outer_values_text(job, scene));
  if (must_be_taut(job)) text += ", the sling taut";
  const auto& constraints = job.optimum.constraints;
  for (std::size_t c = 0; c < constraints.size(); ++c)
    text += fmt::format("{} {}", c == 0 ? ", subject to" : ",", to_text(constraints[c]));
  return text;
}

/// Why no design of a summary is the optimum.
std::string reason_for_no_optimum(const Summary& summary, const Job& job) {
  bool released = false;
  for (std::size_t s = 0; s < status_names.size(); ++s)
    released |= has_speed(static_cast<Status>(s)) && summary.statuses[s] > 0;
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

}  // namespace

std::uint64_t Summary::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

double Summary::utilisation() const {
  return lane_steps == 0 ? 0 : static_cast<double>(steps) / static_cast<double>(lane_steps);
}

std::optional<Optimum> optimum_at(const BestCell& best, const Study& study) {
  if (!best.exists()) return std::nullopt;
  const auto [scene, design] = study.design(best.cell);
  return Optimum{design, best.value, best.speed, best.release_time, scene};
}

Summary to_summary(const Tally& tally, const Study& study) {
  Summary summary;
  summary.statuses = tally.statuses;
  summary.steps = tally.steps;
  summary.lane_steps = tally.lane_steps;
  summary.integration_seconds = tally.integration_seconds;
  summary.sweep_seconds = tally.sweep_seconds;
  summary.optimum = optimum_at(tally.best, study);
  for (const std::uint64_t cell : tally.first_cells) {
    if (cell == no_cell) continue;
    const auto [scene, design] = study.design(cell);
    summary.first_of_statuses.push_back({scene, design});
  }
  return summary;
}

std::optional<RefinedOptimum> best_refined(const Job& job, std::span<const SceneOptimum> optima) {
  const auto scene = best_scene(optima);
  if (!job.optimum.refine || !scene) return std::nullopt;
  const auto& [value, speed, r1, r3, r2, release_time, error] = optima[*scene];
  return RefinedOptimum{{{r1, r3, r2}, value, speed, release_time, *scene}, error};
}

std::string to_text(const Summary& summary, const Job& job) {
  std::string text = fmt::format("designs   {}\n", summary.designs());
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.statuses[s] > 0)
      text += fmt::format("          {} {}\n", summary.statuses[s], status_names[s]);
  text += fmt::format("optimum   {}\n", summary.optimum ? to_text(*summary.optimum, job, true)
                                                        : reason_for_no_optimum(summary, job));
  if (const auto& refined = summary.refined)
    text += fmt::format("refined   {}, error {:.1g}\n", to_text(refined->optimum, job, false),
                        refined->error);
  if (!summary.optima.empty()) text += scene_table(job, summary.optima, summary.complete) + "\n";
  text +=
      fmt::format("error     {}\n", summary.error ? to_text(*summary.error, job.optimum.objective)
                                                  : std::string("not measured"));
  text += fmt::format("steps     {}, lane utilisation {:.1f} %\n", summary.steps,
                      100 * summary.utilisation());
  return text + fmt::format("seconds   {:.2f} ({:.2f} integrating)", summary.sweep_seconds,
                            summary.integration_seconds);
}

}  // namespace trebsweep
