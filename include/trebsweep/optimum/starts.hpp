#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// Designs to search from, best first.
struct Starts {
  std::vector<Design<double>> designs;
  double increment;                       ///< m: of the coarse sweep
  std::uint64_t integrated;               ///< designs
  bool feasible;                          ///< whether the best satisfies the constraints
  std::vector<std::uint64_t> violations;  ///< the number of designs that violate each constraint
};

/// The best local maxima of coarse sweeps: of the job's own lattice, or of coarse_lattice() and
/// edge_lattice(). Throws NoOptimum if nothing is released. Collective.
Starts find_starts(const Job& job, bool own_lattice, ProgressStyle style, MPI_Comm comm);

/// Throws NoOptimum: the constraint that excludes most designs, and the design that comes closest.
[[noreturn]] void refuse_constraints(const DesignProblem& problem, const Starts& starts);

}  // namespace trebsweep
