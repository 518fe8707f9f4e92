#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/sweep/schedule.hpp"

namespace trebsweep {

/// The value of a map in cells outside the lattice.
inline double outside_lattice(Field field) {
  return is_flag(field) ? 0 : std::numeric_limits<double>::quiet_NaN();
}

/// The maps of a tile, one per field of the job with values along r2 fastest, and their tally.
struct ComputedTile {
  std::vector<std::vector<double>> maps;
  Tally tally;
};

/// Integrates the designs of some tiles; nothing if `stop`, which is called every 0.2 s, returns
/// true.
std::optional<std::vector<ComputedTile>> compute(const std::vector<NumberedTile>& tiles,
                                                 const Job& job, const Lattice& lattice,
                                                 const std::function<bool()>& stop);

/// The seconds that a design takes on one core, measured on a sample of the lattice in about 50 ms.
double seconds_per_design(const Job& job, const Lattice& lattice,
                          const std::function<bool()>& stop);

}  // namespace trebsweep
