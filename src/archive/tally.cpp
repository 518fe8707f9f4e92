#include "trebsweep/archive/tally.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trebsweep {

std::uint64_t Tally::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

double Tally::utilisation() const {
  // A kill may have lost the lane steps of tiles that are done.
  const double used = static_cast<double>(steps), all = static_cast<double>(lane_steps);
  return lane_steps == 0 ? 0 : std::min(used / all, 1.0);
}

void Tally::add(const SwingResult& result, std::uint64_t cell, const Design<double>& design,
                double value) {
  const auto status = static_cast<std::size_t>(result.status);
  ++statuses[status];
  first_cells[status] = std::min(first_cells[status], cell);
  steps += result.steps;
  if (!has_speed(result.status) || !std::isfinite(value) || value < best.value) return;
  const BestDesign candidate{
      .value = value, .speed = result.speed, .design = design, .release_time = result.release_time};
  best = better(candidate, best);
}

void Tally::add(const Tally& other) {
  for (std::size_t s = 0; s < statuses.size(); ++s) {
    statuses[s] += other.statuses[s];
    first_cells[s] = std::min(first_cells[s], other.first_cells[s]);
  }
  steps += other.steps;
  lane_steps += other.lane_steps;
  integration_seconds += other.integration_seconds;
  sweep_seconds += other.sweep_seconds;
  best = better(other.best, best);
}

}  // namespace trebsweep
