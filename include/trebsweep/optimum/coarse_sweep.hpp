#pragma once

#include <mpi.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/coarse_grid.hpp"

namespace trebsweep {

/// What a coarse sweep finds.
struct CoarseSweep {
  std::uint64_t designs;  ///< of the grid
  /// The designs with a release that none of their 26 neighbours exceeds, best first. If the best
  /// one violates the constraints, those that satisfy them, among the better designs; if there are
  /// none, those that violate them least. Without a lattice, those without a better one near by.
  /// Empty if nothing is released.
  std::vector<Parameters> maxima;
  bool feasible;                          ///< whether the best of them satisfies the constraints
  std::uint64_t checked;                  ///< the number of designs whose constraints were checked
  std::vector<std::uint64_t> violations;  ///< the number of these that violate each constraint
};

/// Limits that keep a coarse sweep to a few seconds.
struct CoarsePlan {
  double max_time;        ///< s, of a swing
  std::uint64_t designs;  ///< 4,000 to 300,000
};

/// Some parameters of a job's design space, a column for each. Few designs with short arms may take
/// most of the steps of a sweep: of a lattice, they are those of a fine one.
Eigen::MatrixXd coarse_sample(const Job& job, std::size_t count);

/// Plans a coarse sweep by the swings of about 500 designs of a job: a
/// swing may take three times as long as the median of those with a release, since later ones are
/// seldom good, unless the objective or a constraint is about the release time; and the sweep has
/// as many designs as take about a million steps, four million with variables.
CoarsePlan plan_coarse_sweep(const Job& job);

/// Integrates the designs of a grid with moderate accuracy on all ranks, which all get the result.
/// Collective.
CoarseSweep coarse_sweep(const Job& job, const Grid& grid, ProgressStyle style, MPI_Comm comm);

}  // namespace trebsweep
