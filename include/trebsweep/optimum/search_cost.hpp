#pragma once

#include <cstdint>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// What a search for the optimum will cost, as far as it is known before.
struct SearchCost {
  std::uint64_t designs;  ///< of the coarse sweep
  double coarse_seconds;  ///< processor time of the coarse sweep, s
  /// Processor time of what follows it, s: of four thorough searches, with variables of 16 quick
  /// ones without those of evolved() starts.
  double search_seconds;
};

/// Plans the coarse sweep of find_optimum(), and times designs of it and a search from the best of
/// them. `own_lattice` is as in OptimumOptions. Throws InputError as find_optimum() does.
SearchCost search_cost(const Job& job, bool own_lattice);

}  // namespace trebsweep
