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

/// The scenes of a coarse sweep: values of a job's variables from a Sobol sequence, a column for
/// each. Of `designs` in all, there are as many scenes as give lengths and variables the same
/// number of values. A job without variables has one scene.
Eigen::MatrixXd coarse_scenes(const Job& job, std::uint64_t designs);

/// The lattices of designs in several scenes.
struct Grid {
  std::vector<Lattice> lattices;
  Eigen::MatrixXd parameters;  ///< of all designs, those of one lattice after those of another
  Parameters spacing;          ///< of the parameters
};

/// The designs of a lattice in each of some coarse_scenes(). Throws InputError if there are more
/// than 100 million designs, or no scene has any.
Grid grid_of(const Job& job, const LatticeSpec& spec, const Eigen::MatrixXd& scenes);

/// An objective and a violation of the constraints, as of a Point; infinite where nothing is
/// released or the violation is not known.
struct Merit {
  double objective, violation;
};

/// The designs of a grid that none of their neighbours in a lattice exceeds, best first; of several
/// lattices, those without a better one within a spacing. `merit` is that of all designs.
std::vector<std::size_t> local_maxima(const Grid& grid, std::span<const Merit> merit);

}  // namespace trebsweep
