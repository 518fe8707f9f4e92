#pragma once

#include <cstddef>
#include <functional>
#include <span>
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

  /// The mean processor time to integrate a design (s), measured for about 50 ms on a sample.
  double seconds_per_design();

 private:
  /// Integrates designs of a scene. Returns the number of lane steps.
  std::uint64_t integrate(const Scene& scene, std::span<const Design<double>> designs);

  const Study& study_;
  std::size_t maps_;           // their number
  std::vector<Field> fields_;  // of the maps, then the deciding_fields()
  std::vector<SwingResult> swings_;
  std::vector<double> values_;  // as in Batch
  std::size_t at_once_ = 16;
};

}  // namespace trebsweep
