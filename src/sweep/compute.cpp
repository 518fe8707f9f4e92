#include "trebsweep/sweep/compute.hpp"

#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>

#include "trebsweep/archive/layout.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/objective.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
Compute::Compute(const Study& study)
    : study_(study), fields_(stored_fields(study.job().output)), maps_(fields_.size()) {
  std::ranges::copy(deciding_fields(study.job()), std::back_inserter(fields_));
}

void Compute::finish(const Scene& scene, ComputedTile& tile) {
  constexpr std::size_t most_at_once = 4096;  // few enough for the cache
  swings_.resize(designs_.size());
  values_.resize(designs_.size() * fields_.size());
  const double start = MPI_Wtime();
  const Batch batch{designs_, swings_, fields_, values_};
  tile.tally.lane_steps += integrate(scene, study_.job().solver, batch).lane_steps;
  if (designs_.size() >= at_once_)
    at_once_ = std::min(next_count(designs_.size(), MPI_Wtime() - start, 0.2), most_at_once);
  for (std::size_t n = 0; n < designs_.size(); ++n) {
    const auto& [cell, in_study] = cells_[n];
    const auto values = batch.slice(n, 1).values;
    for (std::size_t m = 0; m < tile.maps.size(); ++m)
      if (!is_flag(fields_[m]) || !std::isnan(values[m])) tile.maps[m][cell] = values[m];
    const Operands operands{scene, designs_[n], fields_, values};
    tile.tally.add(swings_[n], in_study, designs_[n], objective(operands, study_.job()));
  }
  designs_.clear();
  cells_.clear();
}

ComputedTile Compute::tile(const Tile& tile, const std::function<void()>& poll) {
  const auto& [number, block] = tile;
  const auto& [first, count] = block;
  const Scene scene = scene_at(study_.job(), number);
  const Lattice& lattice = study_.lattice(number);
  ComputedTile computed;
  for (std::size_t m = 0; m < maps_; ++m)
    computed.maps.emplace_back(block.cells(), fill_value(fields_[m]));
  for (const std::size_t i1 : lattice.r1_indices()) {
    if (i1 < first[0] || i1 >= first[0] + count[0]) continue;
    for (std::size_t i3 = first[1]; i3 < first[1] + count[1]; ++i3) {
      const std::size_t row = ((i1 - first[0]) * count[1] + i3 - first[1]) * count[2];
      const std::uint64_t cell = study_.cell(number, {i1, i3, first[2]});
      for (std::size_t k = 0; k < count[2] && first[2] + k < lattice.row_length(i3); ++k) {
        designs_.push_back(lattice.design({i1, i3, first[2] + k}));
        cells_.push_back({row + k, cell + k});
      }
      if (designs_.size() < at_once_) continue;
      finish(scene, computed);
      poll();
    }
  }
  finish(scene, computed);
  return computed;
}

Tally Compute::timed(std::uint64_t scene, const std::vector<Design<double>>& designs) {
  designs_ = designs;
  cells_.resize(designs_.size());
  ComputedTile results;
  const std::clock_t start = std::clock();
  finish(scene_at(study_.job(), scene), results);
  results.tally.integration_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return results.tally;
}

double Compute::seconds_per_design() {
  constexpr std::size_t parts = 4, part_size = 32;  // a part fills the lanes
  constexpr double enough = 0.05;                   // s
  Tally all;
  for (std::size_t p = 0; p < parts && all.integration_seconds < enough; ++p) {
    const std::uint64_t scene = p * (study_.scenes() - 1) / (parts - 1);
    const auto designs = sample(study_.own_lattice(scene), parts * part_size);
    all.add(timed(scene, every(parts, p, designs)));
  }
  return all.designs() > 0 ? all.integration_seconds / static_cast<double>(all.designs()) : 0;
}

Index3 tile_edge(const Study& study) {
  return tile_edge(study.extent(), study.scenes(), study.job().output.maps,
                   Compute(study).seconds_per_design());
}

}  // namespace trebsweep
