#include "trebsweep/archive/tally.hpp"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>
#include <tuple>

namespace trebsweep {

std::uint64_t Tally::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

void Tally::add(const SwingResult& result, std::uint64_t cell, bool competes) {
  ++statuses[static_cast<std::size_t>(result.status)];
  steps += result.steps;
  if (!competes || !has_speed(result.status)) return;
  if (result.speed > best_speed || (result.speed == best_speed && cell < best_cell)) {
    best_speed = result.speed;
    best_time = result.release_time;
    best_cell = cell;
  }
}

void Tally::add(const Tally& other) {
  for (std::size_t s = 0; s < statuses.size(); ++s) statuses[s] += other.statuses[s];
  steps += other.steps;
  lane_steps += other.lane_steps;
  integration_seconds += other.integration_seconds;
  sweep_seconds += other.sweep_seconds;
  if (std::tuple(-other.best_speed, other.best_cell) < std::tuple(-best_speed, best_cell)) {
    best_speed = other.best_speed;
    best_time = other.best_time;
    best_cell = other.best_cell;
  }
}

TallyRow to_row(const Tally& tally) {
  TallyRow row{};
  std::copy(tally.statuses.begin(), tally.statuses.end(), row.begin());
  const bool has_best = tally.best_speed >= 0;
  const std::array rest{static_cast<double>(tally.steps),
                        static_cast<double>(tally.lane_steps),
                        tally.best_speed,
                        tally.best_time,
                        has_best ? static_cast<double>(tally.best_cell) : -1,
                        tally.integration_seconds,
                        tally.sweep_seconds};
  static_assert(status_names.size() + rest.size() == tally_columns.size());
  std::copy(rest.begin(), rest.end(), row.begin() + status_names.size());
  return row;
}

Tally to_tally(const TallyRow& row) {
  const auto count = [&](std::size_t column) {
    const double value = row[column];
    if (!(value >= 0 && value < 9e15))
      throw std::runtime_error(
          fmt::format("damaged: {} in a tally is {}", tally_columns[column], value));
    return static_cast<std::uint64_t>(value);
  };
  Tally tally;
  for (std::size_t s = 0; s < status_names.size(); ++s) tally.statuses[s] = count(s);
  std::size_t column = status_names.size();
  tally.steps = count(column++);
  tally.lane_steps = count(column++);
  tally.best_speed = row[column++];
  tally.best_time = row[column++];
  if (tally.best_speed >= 0) tally.best_cell = count(column);
  ++column;
  tally.integration_seconds = row[column++];
  tally.sweep_seconds = row[column++];
  return tally;
}

}  // namespace trebsweep
