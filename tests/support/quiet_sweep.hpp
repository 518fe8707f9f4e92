#pragma once

#include <cstring>
#include <optional>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/sweep.hpp"

namespace trebsweep {

/// Options of a sweep without progress that replaces an existing archive.
inline SweepOptions quiet(const std::optional<Index3>& tile_edge = {}) {
  SweepOptions options;
  options.progress = ProgressStyle::none;
  options.tile_edge = tile_edge;
  options.overwrite = true;
  return options;
}

inline bool root() { return mpi::rank(MPI_COMM_WORLD) == 0; }

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace trebsweep
