#include "trebsweep/archive/summary.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>

#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

std::string to_text(const MeasuredError& error) {
  std::string text = fmt::format("{:.2g} median, {:.2g} largest of {} designs", error.median,
                                 error.largest, error.designs);
  if (!std::isnan(error.at_optimum))
    text += fmt::format("; {:.2g} at the optimum", error.at_optimum);
  return text;
}

}  // namespace

std::uint64_t Summary::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

double Summary::utilisation() const {
  return lane_steps == 0 ? 0 : static_cast<double>(steps) / static_cast<double>(lane_steps);
}

Summary to_summary(const Tally& tally, const std::array<std::vector<double>, 3>& axes) {
  Summary summary;
  summary.statuses = tally.statuses;
  summary.steps = tally.steps;
  summary.lane_steps = tally.lane_steps;
  summary.integration_seconds = tally.integration_seconds;
  summary.sweep_seconds = tally.sweep_seconds;
  const auto design_of = [&](std::uint64_t cell) {
    const auto& [r1, r3, r2] = axes;
    return Design<double>{r1[cell / r2.size() / r3.size()], r3[cell / r2.size() % r3.size()],
                          r2[cell % r2.size()]};
  };
  if (tally.best_speed >= 0)
    summary.optimum = {design_of(tally.best_cell), tally.best_speed, tally.best_time};
  for (const std::uint64_t cell : tally.first_cells)
    if (cell != no_cell) summary.first_of_statuses.push_back(design_of(cell));
  return summary;
}

Summary combine(const Tally& tally, const Lattice& lattice, MPI_Comm comm) {
  Tally sum;
  sum.statuses = tally.statuses;
  mpi::sum(sum.statuses, comm);
  std::array steps{tally.steps, tally.lane_steps};
  mpi::sum(steps, comm);
  sum.steps = steps[0];
  sum.lane_steps = steps[1];
  sum.integration_seconds = mpi::sum(tally.integration_seconds, comm);
  sum.sweep_seconds = mpi::sum(tally.sweep_seconds, comm);

  sum.best_speed = mpi::max(tally.best_speed, comm);
  sum.best_cell = mpi::min(tally.best_speed == sum.best_speed ? tally.best_cell : no_cell, comm);
  sum.best_time = mpi::max(tally.best_cell == sum.best_cell ? tally.best_time : -1, comm);
  for (std::size_t s = 0; s < status_names.size(); ++s)
    sum.first_cells[s] = mpi::min(tally.first_cells[s], comm);
  return to_summary(sum, lattice.axes());
}

std::string to_text(const Summary& summary, OptimumFilter optimum_filter) {
  std::string text = fmt::format("designs   {}\n", summary.designs());
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.statuses[s] > 0)
      text += fmt::format("          {} {}\n", summary.statuses[s], status_names[s]);
  if (const auto& best = summary.optimum)
    text += fmt::format(
        "optimum   {:.8f} m/s at r1 = {}, r2 = {}, r3 = {} m, released at {:.8g} s{}\n",
        best->speed, best->design.r1, best->design.r2, best->design.r3, best->release_time,
        optimum_filter == OptimumFilter::taut ? ", the sling taut" : "");
  else
    text += fmt::format("optimum   none: nothing was released{}\n",
                        optimum_filter == OptimumFilter::taut ? " with a taut sling" : "");
  text += fmt::format("error     {}\n",
                      summary.error ? to_text(*summary.error) : std::string("not measured"));
  text += fmt::format("steps     {}, lane utilisation {:.1f} %\n", summary.steps,
                      100 * summary.utilisation());
  return text + fmt::format("seconds   {:.2f} ({:.2f} integrating)", summary.sweep_seconds,
                            summary.integration_seconds);
}

}  // namespace trebsweep
