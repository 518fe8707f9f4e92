#pragma once

#include <functional>
#include <vector>

#include "trebsweep/archive/tally.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// The results of a tile.
struct ComputedTile {
  std::vector<std::vector<double>> maps;  ///< one per stored field, values along r2 fastest
  Tally tally;
};

/// Integrates the designs of tiles, which are in ascending order. Calls `stop` about every 0.2 s;
/// once it is true, finishes the tile that has been begun, and leaves out those after it.
std::vector<ComputedTile> compute(const std::vector<Tile>& tiles, const Study& study,
                                  const std::function<bool()>& stop);

/// The mean processor time to integrate a design (s), measured for about 50 ms on a sample of the
/// study.
double seconds_per_design(const Study& study, const std::function<bool()>& stop);

}  // namespace trebsweep
