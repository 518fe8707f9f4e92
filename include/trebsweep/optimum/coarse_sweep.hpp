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
  /// The designs with a release that none of their 26 neighbours exceeds, best first. Those that
  /// violate constraints come last, by their violation. Empty if nothing is released.
  std::vector<Design<double>> maxima;
};

/// The lattice of a coarse sweep over a job's design space: with the smallest of a series of round
/// increments that makes at most 300,000 designs and 200 values of an axis. Explicit axes keep
/// their ends.
LatticeSpec coarse_lattice(const Scene& scene, const LatticeSpec& spec);

/// The designs between the lower bound of r1 and the first r1 of a coarse lattice, where the
/// objective may change within a fraction of the increment; nothing if the axis r1 is explicit.
std::optional<LatticeSpec> edge_lattice(const Scene& scene, const LatticeSpec& coarse);

/// Integrates the designs of a lattice with moderate accuracy on all ranks, which all get the
/// result. Throws InputError if the lattice has more than 100 million designs. Collective.
CoarseSweep coarse_sweep(const Job& job, const LatticeSpec& spec, ProgressStyle style,
                         MPI_Comm comm);

}  // namespace trebsweep
