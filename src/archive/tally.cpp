#include "trebsweep/archive/tally.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <tuple>

namespace trebsweep {
namespace {

constexpr std::size_t position(std::string_view column) {
  const auto found = std::find(tally_columns.begin(), tally_columns.end(), column);
  return static_cast<std::size_t>(found - tally_columns.begin());
}

constexpr std::size_t best_value = position("best_value"), best_speed = position("best_speed");

}  // namespace

std::uint64_t Tally::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

void Tally::add(const SwingResult& result, std::uint64_t cell, double value) {
  ++statuses[static_cast<std::size_t>(result.status)];
  std::uint64_t& first = first_cells[static_cast<std::size_t>(result.status)];
  first = std::min(first, cell);
  steps += result.steps;
  const bool is_better = value > best_value || (value == best_value && cell < best_cell);
  if (is_better && has_speed(result.status) && std::isfinite(value)) {
    best_value = value;
    best_speed = result.speed;
    best_time = result.release_time;
    best_cell = cell;
  }
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
  if (std::tuple(-other.best_value, other.best_cell) < std::tuple(-best_value, best_cell)) {
    best_value = other.best_value;
    best_speed = other.best_speed;
    best_time = other.best_time;
    best_cell = other.best_cell;
  }
}

TallyRow to_row(const Tally& tally) {
  const auto cell = [](std::uint64_t c) { return c == no_cell ? -1 : static_cast<double>(c); };
  TallyRow row{};
  const std::array rest{static_cast<double>(tally.steps),
                        static_cast<double>(tally.lane_steps),
                        tally.best_value,
                        tally.best_speed,
                        tally.best_time,
                        cell(tally.best_cell),
                        tally.integration_seconds,
                        tally.sweep_seconds};
  static_assert(2 * status_names.size() + rest.size() == tally_columns.size());
  const auto end_of_counts = std::copy(tally.statuses.begin(), tally.statuses.end(), row.begin());
  const auto end_of_rest = std::copy(rest.begin(), rest.end(), end_of_counts);
  std::transform(tally.first_cells.begin(), tally.first_cells.end(), end_of_rest, cell);
  return row;
}

std::vector<std::size_t> stored_columns(unsigned long long format_version) {
  // Versions 3 to 5 store no objective; versions 3 and 4 know eight statuses; version 3 does not
  // store first cells.
  const std::size_t statuses = format_version >= 5 ? status_names.size() : 8;
  const std::size_t first_cells = tally_columns.size() - status_names.size();
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < tally_columns.size(); ++c) {
    const bool is_count = c < status_names.size(), is_first_cell = c >= first_cells;
    const std::size_t status = is_first_cell ? c - first_cells : c;
    if ((is_count || is_first_cell) && status >= statuses) continue;
    if (is_first_cell && format_version < 4) continue;
    if (c == best_value && format_version < 6) continue;
    columns.push_back(c);
  }
  return columns;
}

TallyRow to_current_row(std::span<const double> stored, unsigned long long format_version) {
  TallyRow row = to_row(Tally{});
  const auto columns = stored_columns(format_version);
  for (std::size_t c = 0; c < columns.size(); ++c) row[columns[c]] = stored[c];
  // Before version 6 the objective is the speed, and -1 marks a tile without an optimum.
  if (format_version < 6 && row[best_speed] >= 0) row[best_value] = row[best_speed];
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
  tally.best_value = row[column++];
  tally.best_speed = row[column++];
  tally.best_time = row[column++];
  tally.best_cell = cell();
  tally.integration_seconds = row[column++];
  tally.sweep_seconds = row[column++];
  for (std::uint64_t& first : tally.first_cells) first = cell();
  return tally;
}

}  // namespace trebsweep
