#include "trebsweep/sweep/compute.hpp"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <span>

#include "trebsweep/archive/layout.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/objective.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The fields that a job's maps and its choice of the optimum need in addition to SwingResult's.
std::vector<Field> fields_of(const Job& job) {
  std::vector<Field> fields = stored_fields(job.output);
  const std::vector<Field> deciding = deciding_fields(job);
  fields.insert(fields.end(), deciding.begin(), deciding.end());
  return additional_fields(fields);
}

/// Designs of a tile with the same r1 and r3 and adjacent r2.
struct Row {
  std::size_t tile;     ///< in the list of tiles
  std::uint64_t scene;  ///< of the tile
  Index3 first;         ///< in the box
  std::size_t cell;     ///< of the first design, in the tile's maps
  std::size_t count;    ///< of designs
};

/// The rows of tiles, which are in ascending order.
std::vector<Row> rows_of(const std::vector<Tile>& tiles, const Study& study) {
  std::vector<Row> rows;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const auto& [scene, block] = tiles[t];
    const auto& [first, count] = block;
    const Lattice& lattice = study.lattice(scene);
    const auto& r1 = lattice.r1_indices();
    for (auto i1 = std::ranges::lower_bound(r1, first[0]);
         i1 != r1.end() && *i1 < first[0] + count[0]; ++i1)
      for (std::size_t k3 = 0; k3 < count[1]; ++k3) {
        const Index3 start{*i1, first[1] + k3, first[2]};
        const std::size_t end = std::min(lattice.row_length(start[1]), first[2] + count[2]);
        const std::size_t cell = ((*i1 - first[0]) * count[1] + k3) * count[2];
        if (end > first[2]) rows.push_back({t, scene, start, cell, end - first[2]});
      }
  }
  return rows;
}

/// Designs of one scene to integrate together, and their results with the fields that a job needs.
struct Slice {
  explicit Slice(const Job& job) : fields(fields_of(job)) {}

  Batch batch() { return {designs, swings, fields, values}; }

  /// Integrates the designs. Returns the number of lane steps.
  std::uint64_t integrate(const Scene& scene, const Solver& solver) {
    swings.resize(designs.size());
    values.resize(designs.size() * fields.size());
    return trebsweep::integrate(scene, solver, batch()).lane_steps;
  }

  std::vector<Field> fields;
  std::vector<Design<double>> designs;
  std::vector<SwingResult> swings;
  std::vector<double> values;  // as in Batch
};

/// Takes the designs of the first rows, of one scene: at least `count`, if it has as many. Returns
/// the rows.
std::span<const Row> take(std::span<const Row> rows, std::size_t count, const Lattice& lattice,
                          std::vector<Design<double>>& designs) {
  designs.clear();
  std::size_t n = 0;
  for (; n < rows.size() && rows[n].scene == rows[0].scene && designs.size() < count; ++n) {
    const auto& [i1, i3, i2] = rows[n].first;
    for (std::size_t k = 0; k < rows[n].count; ++k)
      designs.push_back(lattice.design({i1, i3, i2 + k}));
  }
  return rows.first(n);
}

/// Adds the results of a row and its designs' objectives to its tile.
void store(const Study& study, const std::vector<Field>& fields, const Batch& batch,
           std::span<const double> objectives, const Row& row, ComputedTile& tile) {
  for (std::size_t f = 0; f < fields.size(); ++f) {
    double* const map = tile.maps[f].data() + row.cell;
    const bool flag = is_flag(fields[f]);
    for_each_value(batch, fields[f], [&](std::size_t k, double value) {
      map[k] = flag && std::isnan(value) ? 0 : value;
    });
  }
  const std::uint64_t cell = study.cell(row.scene, row.first);
  for (std::size_t k = 0; k < row.count; ++k)
    tile.tally.add(batch.results[k], cell + k, batch.designs[k], objectives[k]);
}

}  // namespace

std::vector<ComputedTile> compute(const std::vector<Tile>& tiles, const Study& study,
                                  const std::function<bool()>& stop) {
  const Job& job = study.job();
  // Slices take at most about 0.2 s, since slow designs can take minutes per tile. Small ones stay
  // in the cache.
  constexpr std::uint64_t max_count = 4096;
  std::uint64_t lane_steps = 0, count = 16;
  std::vector<ComputedTile> computed(tiles.size());
  const std::vector<Field> fields = stored_fields(job.output);
  for (std::size_t t = 0; t < tiles.size(); ++t)
    for (const Field field : fields)
      computed[t].maps.emplace_back(tiles[t].block.cells(), fill_value(field));
  const std::vector<Row> rows = rows_of(tiles, study);
  std::span<const Row> left = rows;
  std::size_t begun = 0;  // tiles
  for (Slice slice(job); !left.empty();) {
    if (begun > 0 && stop()) {
      computed.resize(begun);
      left = left.first(static_cast<std::size_t>(
          std::ranges::lower_bound(left, begun, {}, &Row::tile) - left.begin()));
      if (left.empty()) break;
    }
    const std::uint64_t number = left.front().scene;
    const auto taken = take(left, count, study.lattice(number), slice.designs);
    const Scene scene = scene_at(job, number);
    const double start = MPI_Wtime();
    lane_steps += slice.integrate(scene, job.solver);
    count = std::min(next_count(count, MPI_Wtime() - start, 0.2), max_count);
    const std::vector<double> values = objectives(slice.batch(), job);
    for (std::size_t n = 0; const Row& row : taken) {
      store(study, fields, slice.batch().slice(n, row.count),
            std::span(values).subspan(n, row.count), row, computed[row.tile]);
      n += row.count;
    }
    begun = taken.back().tile + 1;
    left = left.subspan(taken.size());
  }
  // Packs cross tiles, so that lane steps can only be counted for all tiles together.
  if (!computed.empty()) computed.front().tally.lane_steps = lane_steps;
  return computed;
}

double seconds_per_design(const Study& study, const std::function<bool()>& stop) {
  constexpr std::size_t parts = 4, part_size = 32;  // a part fills the lanes
  constexpr double enough = 0.05;                   // s
  const Job& job = study.job();
  double seconds = 0;
  std::size_t done = 0;
  Slice slice(job);
  for (std::size_t p = 0; p < parts && seconds < enough && !stop(); ++p) {
    const std::uint64_t number = p * (study.scenes() - 1) / (parts - 1);
    const Scene scene = scene_at(job, number);
    const auto designs = sample(study.own_lattice(number), parts * part_size);
    // Every parts-th design of a sample, so that each part is representative.
    slice.designs.clear();
    for (std::size_t i = p; i < designs.size(); i += parts) slice.designs.push_back(designs[i]);
    if (slice.designs.empty()) continue;
    const std::clock_t start = std::clock();  // of the processor: others may use it as well
    slice.integrate(scene, job.solver);
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    done += slice.designs.size();
  }
  return done > 0 ? seconds / static_cast<double>(done) : 0;
}

}  // namespace trebsweep
