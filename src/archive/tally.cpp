#include "trebsweep/archive/tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace trebsweep {

std::uint64_t Tally::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

void Tally::add(const SwingResult& result, std::uint64_t cell, double value) {
  ++statuses[static_cast<std::size_t>(result.status)];
  std::uint64_t& first = first_cells[static_cast<std::size_t>(result.status)];
  first = std::min(first, cell);
  steps += result.steps;
  const BestCell candidate{value, result.speed, result.release_time, cell};
  if (has_speed(result.status) && std::isfinite(value) && candidate > best) best = candidate;
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
  if (other.best > best) best = other.best;
}

TallyRow to_row(const Tally& tally) {
  const auto cell = [](std::uint64_t c) { return c == no_cell ? -1 : static_cast<double>(c); };
  TallyRow row{};
  const std::array rest{static_cast<double>(tally.steps),
                        static_cast<double>(tally.lane_steps),
                        tally.best.value,
                        tally.best.speed,
                        tally.best.release_time,
                        cell(tally.best.cell),
                        tally.integration_seconds,
                        tally.sweep_seconds};
  static_assert(2 * status_names.size() + rest.size() == tally_columns.size());
  const auto end_of_counts = std::copy(tally.statuses.begin(), tally.statuses.end(), row.begin());
  const auto end_of_rest = std::copy(rest.begin(), rest.end(), end_of_counts);
  std::transform(tally.first_cells.begin(), tally.first_cells.end(), end_of_rest, cell);
  return row;
}

Tally to_tally(const TallyRow& row) {
  std::size_t column = 0;
  const auto count = [&] {
    const double value = row[column++];
    if (!(value >= 0 && value < 9e15))
      throw std::runtime_error(
          fmt::format("damaged: {} in a tally is {}", tally_columns[column - 1], value));
    return static_cast<std::uint64_t>(value);
  };
  const auto cell = [&] {
    if (row[column] != -1) return count();
    ++column;
    return no_cell;
  };
  Tally tally;
  for (std::uint64_t& status : tally.statuses) status = count();
  tally.steps = count();
  tally.lane_steps = count();
  tally.best.value = row[column++];
  tally.best.speed = row[column++];
  tally.best.release_time = row[column++];
  tally.best.cell = cell();
  tally.integration_seconds = row[column++];
  tally.sweep_seconds = row[column++];
  for (std::uint64_t& first : tally.first_cells) first = cell();
  return tally;
}

}  // namespace trebsweep
