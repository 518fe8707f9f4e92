#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "trebsweep/archive/tally.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// The results of a tile.
struct ComputedTile {
  std::vector<std::vector<double>> maps;  ///< one per stored field, values along r2 fastest
  Tally tally;
};

/// Integrates the designs of a study.
class Compute {
 public:
  explicit Compute(const Study& study);

  /// Integrates the designs of a tile, some at a time. Calls poll() in between, about every 0.2 s.
  ComputedTile tile(const Tile& tile, const std::function<void()>& poll);

  /// Integrates designs of a scene at once. The tally's integration_seconds are the processor time
  /// that this took: others may use the processor as well.
  Tally timed(std::uint64_t scene, const std::vector<Design<double>>& designs);

  /// The mean processor time to integrate a design (s), measured for about 50 ms on a sample.
  double seconds_per_design();

 private:
  /// Integrates the next designs, of one scene, and adds their results to a tile.
  void finish(const Scene& scene, ComputedTile& tile);

  const Study& study_;
  std::vector<Field> fields_;  // of the maps, then the deciding_fields()
  std::size_t maps_;
  std::size_t at_once_ = 16;  // designs to integrate
  // The next designs and their results, kept to be reused.
  std::vector<Design<double>> designs_;
  std::vector<std::pair<std::size_t, std::uint64_t>> cells_;  // in the tile, and Study::cell()
  std::vector<SwingResult> swings_;
  std::vector<double> values_;  // as in Batch
};

/// The extent of the tiles of a new sweep, for which designs are timed.
Index3 tile_edge(const Study& study);

}  // namespace trebsweep
