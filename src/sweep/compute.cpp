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
namespace {

/// The index of a cell in a block, r2 fastest.
std::size_t cell_in(const Block& block, const Index3& index) {
  const auto& [first, count] = block;
  return ((index[0] - first[0]) * count[1] + index[1] - first[1]) * count[2] + index[2] - first[2];
}

}  // namespace

Compute::Compute(const Study& study) : study_(study), fields_(stored_fields(study.job().output)) {
  maps_ = fields_.size();
  std::ranges::copy(deciding_fields(study.job()), std::back_inserter(fields_));
}

std::uint64_t Compute::integrate(const Scene& scene, std::span<const Design<double>> designs) {
  swings_.resize(designs.size());
  values_.resize(designs.size() * fields_.size());
  const Batch batch{designs, swings_, fields_, values_};
  return trebsweep::integrate(scene, study_.job().solver, batch).lane_steps;
}

ComputedTile Compute::tile(const Tile& tile, const std::function<void()>& poll) {
  constexpr std::size_t most_at_once = 4096;  // few enough for the cache
  const auto& [number, block] = tile;
  const Scene scene = scene_at(study_.job(), number);
  const Lattice& lattice = study_.lattice(number);
  ComputedTile computed;
  for (std::size_t m = 0; m < maps_; ++m)
    computed.maps.emplace_back(block.cells(), fill_value(fields_[m]));
  const std::vector<Index3> indices = indices_in(lattice, block);
  for (std::span left(indices); !left.empty(); poll()) {
    const auto taken = left.first(std::min(at_once_, left.size()));
    left = left.subspan(taken.size());
    const auto designs = designs_at(taken, lattice);
    const double start = MPI_Wtime();
    computed.tally.lane_steps += integrate(scene, designs);
    if (taken.size() == at_once_)
      at_once_ = std::min(next_count(at_once_, MPI_Wtime() - start, 0.2), most_at_once);
    for (std::size_t n = 0; n < taken.size(); ++n) {
      const auto values = std::span(values_).subspan(n * fields_.size(), fields_.size());
      const std::size_t cell = cell_in(block, taken[n]);
      for (std::size_t m = 0; m < maps_; ++m)
        if (!is_flag(fields_[m]) || !std::isnan(values[m])) computed.maps[m][cell] = values[m];
      computed.tally.add(swings_[n], study_.cell(number, taken[n]), designs[n],
                         objective(values.subspan(maps_), study_.job()));
    }
  }
  return computed;
}

double Compute::seconds_per_design() {
  constexpr std::size_t parts = 4, part_size = 32;  // a part fills the lanes
  constexpr double enough = 0.05;                   // s
  double seconds = 0;
  std::size_t done = 0;
  for (std::size_t p = 0; p < parts && seconds < enough; ++p) {
    const std::uint64_t number = p * (study_.scenes() - 1) / (parts - 1);
    const auto designs = sample(study_.own_lattice(number), parts * part_size);
    // Every parts-th design of a sample, so that each part is representative.
    std::vector<Design<double>> part;
    for (std::size_t i = p; i < designs.size(); i += parts) part.push_back(designs[i]);
    const std::clock_t start = std::clock();  // of the processor: others may use it as well
    integrate(scene_at(study_.job(), number), part);
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    done += part.size();
  }
  return done > 0 ? seconds / static_cast<double>(done) : 0;
}

}  // namespace trebsweep
