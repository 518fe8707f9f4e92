#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/optimum/design_space.hpp"

namespace trebsweep {

/// The lattice of a coarse sweep over a job's design space: with the smallest of a series of round
/// increments that makes at most `enough_designs` and 200 values of an axis. Explicit axes keep
/// their ends.
LatticeSpec coarse_lattice(const Scene& scene, const LatticeSpec& spec,
                           std::uint64_t enough_designs = 300'000);

/// The designs between the lower bound of r1 and the first r1 of a coarse lattice, where the
/// objective may change within a fraction of the increment; nothing if the axis r1 is explicit.
std::optional<LatticeSpec> edge_lattice(const Scene& scene, const LatticeSpec& coarse);

/// The designs of a coarse sweep.
struct Grid {
  Eigen::MatrixXd parameters;      ///< of all designs, a column for each
  std::optional<Lattice> lattice;  ///< whose designs they are, in its order
  double increment;                ///< m, of the lattice; 0 without one or for a single design
  Parameters spacing;  ///< without a lattice: the mean distance of parameters in the box
};

/// The lattice of a coarse sweep. Throws InputError if it has more than 100 million designs.
Lattice checked_lattice(const Scene& scene, const LatticeSpec& spec);

/// The designs of a lattice. Throws as checked_lattice() does.
Grid lattice_grid(const Scene& scene, const LatticeSpec& spec);

/// About `designs` designs of a job's design_space(), in scenes with values of its variables from a
/// Sobol sequence and lengths from another. There are as many scenes as give lengths and variables
/// the same number of values. Leaves out designs that cannot start or whose start violates a
/// constraint, if there are others. Throws NoOptimum if no design is found.
Grid sobol_grid(const Job& job, std::uint64_t designs);

/// An objective and a violation of the constraints, as of a Point; infinite where nothing is
/// released or the violation is not known.
struct Merit {
  double objective, violation;
};

/// The designs of a grid that none of their neighbours in the lattice exceeds, best first; without
/// a lattice, those of the best 5,000 that have no better one within a spacing. `merit` is that of
/// all designs.
std::vector<std::size_t> local_maxima(const Grid& grid, std::span<const Merit> merit);

}  // namespace trebsweep
