#include "trebsweep/summary.hpp"

#include <fmt/format.h>

#include <array>
#include <numeric>

#include "trebsweep/mpi.hpp"

namespace trebsweep {

std::uint64_t Summary::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

double Summary::utilisation() const {
  return lane_steps == 0 ? 0 : static_cast<double>(steps) / static_cast<double>(lane_steps);
}

void Tally::add(const Shot& shot, std::uint64_t cell, bool competes) {
  ++statuses[static_cast<std::size_t>(shot.status)];
  steps += shot.steps;
  if (!competes || !is_shot(shot.status)) return;
  if (shot.speed > best_speed || (shot.speed == best_speed && cell < best_cell)) {
    best_speed = shot.speed;
    best_time = shot.release_time;
    best_cell = cell;
  }
}

Summary combine(const Tally& tally, const Lattice& lattice, MPI_Comm comm) {
  constexpr auto no_cell = std::numeric_limits<std::uint64_t>::max();
  Summary summary;
  summary.statuses = tally.statuses;
  mpi::sum(summary.statuses, comm);
  std::array steps{tally.steps, tally.lane_steps};
  mpi::sum(steps, comm);
  summary.steps = steps[0];
  summary.lane_steps = steps[1];

  const double speed = mpi::max(tally.best_speed, comm);
  const std::uint64_t cell = mpi::min(tally.best_speed == speed ? tally.best_cell : no_cell, comm);
  if (cell == no_cell) return summary;
  const double time = mpi::max(tally.best_cell == cell ? tally.best_time : -1, comm);
  const Index3 extent = lattice.extent();
  const Index3 place{cell / (extent[1] * extent[2]), cell / extent[2] % extent[1],
                     cell % extent[2]};
  summary.optimum = {lattice.design(place), speed, time};
  return summary;
}

std::string to_text(const Summary& summary, const Job& job, int ranks) {
  std::string text = fmt::format("designs   {}\n", summary.designs());
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.statuses[s] > 0)
      text += fmt::format("          {} {}\n", summary.statuses[s], status_names[s]);
  if (const auto& best = summary.optimum)
    text += fmt::format(
        "optimum   {:.8f} m/s at r1 = {}, r2 = {}, r3 = {} m, released at {:.8g} s{}\n",
        best->speed, best->design.r1, best->design.r2, best->design.r3, best->release_time,
        job.output.contest == Contest::taut ? ", the sling taut" : "");
  else
    text += fmt::format("optimum   none: nothing was released{}\n",
                        job.output.contest == Contest::taut ? " with a taut sling" : "");
  text += fmt::format("steps     {}, lanes {:.1f} % at work\n", summary.steps,
                      100 * summary.utilisation());
  text += fmt::format("seconds   {:.2f} ({:.2f} integrating) on {} {}\n", summary.sweep_seconds,
                      summary.integration_seconds, ranks, ranks == 1 ? "rank" : "ranks");
  return text + fmt::format("archive   {}\n", job.output.file);
}

}  // namespace trebsweep
