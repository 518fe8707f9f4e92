#pragma once

#include <mpi.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// What a coarse sweep finds.
struct CoarseSweep {
  double increment;       ///< m; 0 if there is only one design
  std::uint64_t designs;  ///< of the lattice
  /// The designs with a release that none of their 26 neighbours exceeds, best first. If the best
  /// one violates the constraints, those that satisfy them, among the better designs; if there are
  /// none, those that violate them least. Empty if nothing is released.
  std::vector<Design<double>> maxima;
  bool feasible;                          ///< whether the best of them satisfies the constraints
  std::uint64_t checked;                  ///< the number of designs whose constraints were checked
  std::vector<std::uint64_t> violations;  ///< the number of these that violate each constraint
};

/// Limits that keep a coarse sweep to about a second or two.
struct CoarsePlan {
  double max_time;        ///< s, of a swing
  std::uint64_t designs;  ///< 4,000 to 300,000
};

/// Plans a coarse sweep by the swings of about 500 designs of a job: a swing may take three times
/// as long as the median of those with a release, since later ones are seldom good, unless the
/// objective or a constraint is about the release time; and the sweep has as many designs as take
/// about a million steps.
CoarsePlan plan_coarse_sweep(const Job& job);

/// The lattice of a coarse sweep over a job's design space: with the smallest of a series of round
/// increments that makes at most `enough_designs` and 200 values of an axis. Explicit axes keep
/// their ends.
LatticeSpec coarse_lattice(const Scene& scene, const LatticeSpec& spec,
                           std::uint64_t enough_designs = 300'000);

/// The designs between the lower bound of r1 and the first r1 of a coarse lattice, where the
/// objective may change within a fraction of the increment; nothing if the axis r1 is explicit.
std::optional<LatticeSpec> edge_lattice(const Scene& scene, const LatticeSpec& coarse);

/// Integrates the designs of a lattice with moderate accuracy on all ranks, which all get the
/// result. Throws InputError if the lattice has more than 100 million designs. Collective.
CoarseSweep coarse_sweep(const Job& job, const LatticeSpec& spec, ProgressStyle style,
                         MPI_Comm comm);

}  // namespace trebsweep
