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

/// The summary of a job's sweep, whose archive may not exist yet. Collective.
inline Summary summary_of(const Job& job, const SweepOptions& options = quiet()) {
  return sweep(Study(job), options, MPI_COMM_WORLD).value().summary;
}

/// The best design of all scenes, which must exist.
inline const BestDesign& best_of(const Summary& summary) {
  return summary.optima.at(summary.best().value());
}

inline bool root() { return mpi::rank(MPI_COMM_WORLD) == 0; }

inline bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace trebsweep
