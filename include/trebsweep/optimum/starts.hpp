#pragma once

#include <mpi.h>

#include <cstdint>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// Parameters to search from, best first.
struct Starts {
  std::vector<Parameters> parameters;
  std::vector<Parameters> others;         ///< of a job with variables: the next best
  double increment = 0;                   ///< m: of the coarse sweep
  Parameters spacing;                     ///< of the coarse sweep, where there are variables
  std::uint64_t integrated = 0;           ///< designs
  double max_time = 0;                    ///< s, of its swings
  bool feasible = false;                  ///< whether the best satisfies the constraints
  std::uint64_t checked = 0;              ///< the number of designs whose constraints were checked
  std::vector<std::uint64_t> violations;  ///< the number of these that violate each constraint
};

/// The best local maxima of coarse sweeps, with the swings of plan_coarse_sweep(): of the job's own
/// lattice, or of coarse_lattice() and edge_lattice(). Throws NoOptimum if nothing is released.
/// Collective.
Starts find_starts(const Job& job, bool own_lattice, ProgressStyle style, MPI_Comm comm);

/// The best designs that evolve() finds from all starts of a job with variables, at most 16 that
/// differ; none if it finds no feasible one. Adds the number of designs that it integrates to
/// `integrated`. Collective.
std::vector<Parameters> evolved(const DesignProblem& problem, const Starts& starts,
                                ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated);

/// Throws NoOptimum: the constraint that excludes most designs, and the design that comes closest.
[[noreturn]] void refuse_constraints(const DesignProblem& problem, const Starts& starts);

}  // namespace trebsweep
