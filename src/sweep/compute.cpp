#include "trebsweep/sweep/compute.hpp"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The fields that a job's maps and its choice of the optimum need in addition to SwingResult's.
std::vector<Field> additional_fields(const Output& output) {
  std::vector<Field> fields;
  std::copy_if(output.fields.begin(), output.fields.end(), std::back_inserter(fields),
               [](Field field) { return !is_basic(field); });
  if (output.optimum_filter == OptimumFilter::taut &&
      std::count(fields.begin(), fields.end(), Field::slack) == 0)
    fields.push_back(Field::slack);
  return fields;
}

/// The results of designs, with the fields that a job needs.
struct Results {
  Results(const Job& job, std::size_t designs)
      : fields(additional_fields(job.output)), swings(designs), values(designs * fields.size()) {}

  std::vector<Field> fields;
  std::vector<SwingResult> swings;
  std::vector<double> values;  // as in Batch

  double value(std::size_t n, Field field) const {
    switch (field) {
      case Field::speed:
        return swings[n].speed;
      case Field::release_time:
        return swings[n].release_time;
      case Field::status:
        return static_cast<double>(swings[n].status);
      case Field::steps:
        return static_cast<double>(swings[n].steps);
      default:
        break;
    }
    const auto found = std::find(fields.begin(), fields.end(), field);
    if (found == fields.end()) throw std::logic_error("a field that was not integrated");
    return values[n * fields.size() + static_cast<std::size_t>(found - fields.begin())];
  }
};

/// Calls f(i, cell) for each design of a tile: its index in the lattice and in the tile's maps.
template <class F>
void for_each_design(const Lattice& lattice, const Tile& tile, F f) {
  std::size_t cell = 0;
  for (std::size_t i1 = tile.first[0]; i1 < tile.first[0] + tile.count[0]; ++i1)
    for (std::size_t i3 = tile.first[1]; i3 < tile.first[1] + tile.count[1]; ++i3)
      for (std::size_t i2 = tile.first[2]; i2 < tile.first[2] + tile.count[2]; ++i2, ++cell)
        if (lattice.holds({i1, i3, i2})) f(Index3{i1, i3, i2}, cell);
}

/// Integrates a batch in slices of about 0.2 s, since slow designs can take minutes per tile.
/// Returns the number of lane steps, or nothing once `stop` is true.
std::optional<std::uint64_t> integrate_unless_stopped(const Job& job, const Batch& batch,
                                                      const std::function<bool()>& stop) {
  std::uint64_t lane_steps = 0, slice = 16;
  for (std::size_t first = 0; first < batch.designs.size();) {
    if (stop()) return std::nullopt;
    const std::size_t count = std::min(slice, batch.designs.size() - first);
    const double start = MPI_Wtime();
    lane_steps += integrate(job.scene, job.solver, batch.slice(first, count)).lane_steps;
    slice = next_count(slice, MPI_Wtime() - start, 0.2);
    first += count;
  }
  return lane_steps;
}

/// Attributes lane steps to tiles in proportion to their steps. Packs cross tiles, so that they can
/// only be counted for all tiles together.
void share_lane_steps(std::uint64_t lane_steps, std::vector<ComputedTile>& tiles) {
  std::uint64_t steps_left = 0;
  for (const ComputedTile& tile : tiles) steps_left += tile.tally.steps;
  for (auto& [maps, tally] : tiles) {
    const double share = static_cast<double>(tally.steps) /
                         static_cast<double>(std::max<std::uint64_t>(1, steps_left));
    tally.lane_steps = static_cast<std::uint64_t>(share * static_cast<double>(lane_steps));
    steps_left -= tally.steps;
    lane_steps -= tally.lane_steps;
  }
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
  Results results(job, designs.size());
  const auto lane_steps = integrate_unless_stopped(
      job, {designs, results.swings, results.fields, results.values}, stop);
  if (!lane_steps) return std::nullopt;

  const std::vector<Field>& fields = job.output.fields;
  const Index3 extent = lattice.extent();
  std::vector<ComputedTile> computed(tiles.size());
  std::size_t n = 0;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const Tile& tile = tiles[t].tile;
    auto& maps = computed[t].maps;
    for (const Field field : fields) maps.emplace_back(tile.cells(), fill_value(field));
    for_each_design(lattice, tile, [&](const Index3& i, std::size_t cell) {
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const double value = results.value(n, fields[f]);
        maps[f][cell] = is_flag(fields[f]) && std::isnan(value) ? 0 : value;
      }
      const bool competes = job.output.optimum_filter == OptimumFilter::all ||
                            results.value(n, Field::slack) == 1;  // taut
      computed[t].tally.add(results.swings[n], (i[0] * extent[1] + i[1]) * extent[2] + i[2],
                            competes);
      ++n;
    });
  }
  share_lane_steps(*lane_steps, computed);
  return computed;
}

double seconds_per_design(const Job& job, const Lattice& lattice,
                          const std::function<bool()>& stop) {
  const auto designs = sample(lattice, 128);
  constexpr std::size_t part_size = 16;  // fills the lanes
  constexpr double enough = 0.05;        // s
  const std::size_t parts = (designs.size() + part_size - 1) / part_size;
  const double start = MPI_Wtime();
  double seconds = 0;
  std::size_t done = 0;
  for (std::size_t p = 0; p < parts && seconds < enough && !stop(); ++p) {
    std::vector<Design<double>> part;  // every parts-th design, so that each part is representative
    for (std::size_t i = p; i < designs.size(); i += parts) part.push_back(designs[i]);
    Results results(job, part.size());
    integrate(job.scene, job.solver, {part, results.swings, results.fields, results.values});
    done += part.size();
    seconds = MPI_Wtime() - start;
  }
  return done > 0 ? seconds / static_cast<double>(done) : 0;
}

}  // namespace trebsweep
