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
  std::vector<std::uint64_t> violations;  ///< the number of designs that violate each constraint
};

/// The number of designs that a coarse sweep of a job may have, 8,000 to 300,000: those that take
/// about four million steps, as measured on some hundred designs.
std::uint64_t affordable_designs(const Job& job);

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
