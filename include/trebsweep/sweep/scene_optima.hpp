#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {

/// Finds the optimum near a design of a job with one scene, between the designs of its lattice.
using Refine =
    std::function<std::optional<RefinedOptimum>(const Job& job, const Design<double>& design)>;

/// The optima of consecutive scenes of a study, whose tiles are all done. `tallies`, which only
/// rank 0 needs, are those of the scenes. With optimum.refine, they are those that `refine` finds,
/// if it finds one. Otherwise they are the best designs of the lattices, and their errors are the
/// differences of their values from those of integrate_accurately(), or NaN without solver.check.
/// The ranks share the scenes. Collective; the same on all ranks. Returns nothing once `stop` is
/// true on any rank. Throws mpi::RootError if `refine` throws.
std::optional<std::vector<SceneOptimum>> scene_optima(
    const Study& study, std::uint64_t first, std::uint64_t count, std::span<const Tally> tallies,
    const Refine& refine, const std::function<bool()>& stop, MPI_Comm comm);

}  // namespace trebsweep
