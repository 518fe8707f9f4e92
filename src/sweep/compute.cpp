#include "trebsweep/sweep/compute.hpp"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <stdexcept>

#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The fields beyond those of every shot that a job's maps, or its choice of the optimum, need.
std::vector<Field> extra_fields(const Output& output) {
  std::vector<Field> extra;
  std::copy_if(output.fields.begin(), output.fields.end(), std::back_inserter(extra),
               [](Field field) { return !is_basic(field); });
  if (output.optimum_filter == OptimumFilter::taut &&
      std::count(extra.begin(), extra.end(), Field::slack) == 0)
    extra.push_back(Field::slack);
  return extra;
}

/// Calls f(i, cell) for each design of a tile: its place in the lattice, and in the tile's maps.
template <class F>
void for_each_design(const Lattice& lattice, const Tile& tile, F f) {
  std::size_t cell = 0;
  for (std::size_t i1 = tile.first[0]; i1 < tile.first[0] + tile.count[0]; ++i1)
    for (std::size_t i3 = tile.first[1]; i3 < tile.first[1] + tile.count[1]; ++i3)
      for (std::size_t i2 = tile.first[2]; i2 < tile.first[2] + tile.count[2]; ++i2, ++cell)
        if (lattice.holds({i1, i3, i2})) f(Index3{i1, i3, i2}, cell);
}

double basic_value(const SwingResult& result, Field field) {
  switch (field) {
    case Field::speed:
      return result.speed;
    case Field::release_time:
      return result.release_time;
    case Field::status:
      return static_cast<double>(result.status);
    case Field::steps:
      return static_cast<double>(result.steps);
    default:
      throw std::logic_error("not a field of every shot");
  }
}

/// Integrates designs, asking now and then whether to stop: slow ones can take minutes per tile.
/// Returns the lanes' steps, or nothing if told to stop.
std::optional<std::uint64_t> integrate_unless_stopped(const Job& job, const Batch& batch,
                                                      const std::function<bool()>& stop) {
  std::uint64_t lane_steps = 0, slice = 16;
  for (std::size_t first = 0; first < batch.designs.size();) {
    if (stop()) return std::nullopt;
    const std::size_t count = std::min(slice, batch.designs.size() - first);
    const double start = MPI_Wtime();
    lane_steps += integrate(job.scene, job.solver, batch.slice(first, count)).lane_steps;
    slice = paced(slice, MPI_Wtime() - start, 0.2);
    first += count;
  }
  return lane_steps;
}

}  // namespace

std::optional<std::vector<ComputedTile>> compute(const std::vector<NumberedTile>& tiles,
                                                 const Job& job, const Lattice& lattice,
                                                 const std::function<bool()>& stop) {
  if (stop()) return std::nullopt;
  std::vector<Design<double>> designs;
  for (const auto& [number, tile] : tiles)
    for_each_design(lattice, tile,
                    [&](const Index3& i, std::size_t) { designs.push_back(lattice.design(i)); });
  const std::vector<Field> extra = extra_fields(job.output);
  std::vector<SwingResult> results(designs.size());
  std::vector<double> values(designs.size() * extra.size());
  const auto lane_steps = integrate_unless_stopped(job, {designs, results, extra, values}, stop);
  if (!lane_steps) return std::nullopt;

  const auto place = [&](Field field) {
    return static_cast<std::size_t>(std::find(extra.begin(), extra.end(), field) - extra.begin());
  };
  std::vector<ComputedTile> computed;
  std::size_t n = 0;
  const Index3 extent = lattice.extent();
  for (const auto& [number, tile] : tiles) {
    auto& [maps, tally] = computed.emplace_back();
    for (const Field field : job.output.fields)
      maps.emplace_back(tile.cells(), outside_lattice(field));
    for_each_design(lattice, tile,
                    [&, &maps = maps, &tally = tally](const Index3& i, std::size_t cell) {
                      const SwingResult& result = results[n];
                      const double* const extras = values.data() + n * extra.size();
                      for (std::size_t f = 0; f < maps.size(); ++f) {
                        const Field field = job.output.fields[f];
                        const double value =
                            is_basic(field) ? basic_value(result, field) : extras[place(field)];
                        maps[f][cell] = is_flag(field) && std::isnan(value) ? 0 : value;
                      }
                      const bool competes = job.output.optimum_filter == OptimumFilter::all ||
                                            extras[place(Field::slack)] == 1;  // taut
                      tally.add(result, (i[0] * extent[1] + i[1]) * extent[2] + i[2], competes);
                      ++n;
                    });
  }
  if (!computed.empty()) computed.front().tally.lane_steps = *lane_steps;
  return computed;
}

double seconds_per_design(const Job& job, const Lattice& lattice,
                          const std::function<bool()>& stop) {
  const auto designs = sample(lattice, 128);
  const std::vector<Field> extra = extra_fields(job.output);
  constexpr std::size_t part = 16;  // fills the lanes
  constexpr double enough = 0.05;
  const std::size_t parts = (designs.size() + part - 1) / part;
  const double start = MPI_Wtime();
  double seconds = 0;
  std::size_t done = 0;
  for (std::size_t p = 0; p < parts && seconds < enough && !stop(); ++p) {
    std::vector<Design<double>> some;  // spread over the whole sample
    for (std::size_t i = p; i < designs.size(); i += parts) some.push_back(designs[i]);
    std::vector<SwingResult> results(some.size());
    std::vector<double> values(some.size() * extra.size());
    integrate(job.scene, job.solver, {some, results, extra, values});
    done += some.size();
    seconds = MPI_Wtime() - start;
  }
  return done > 0 ? seconds / static_cast<double>(done) : 0;
}

}  // namespace trebsweep
