#pragma once

#include <functional>
#include <optional>

#include "trebsweep/archive/best_design.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Finds the optimum near a design of a job with one scene, between the designs of its lattice.
using Refine =
    std::function<std::optional<BestDesign>(const Job& job, const Design<double>& design)>;

/// The optimum of a scene, from the best design of its lattice, and whether it can be built. `job`
/// is that of the scene alone. With optimum.refine, it is the one that `refine` finds, if it finds
/// one. Otherwise it is the best design of the lattice, and its error is the difference of its
/// value from that of integrate_accurately(), or NaN without solver.check.
BestDesign scene_optimum(const Job& job, const BestDesign& best, const Refine& refine);

}  // namespace trebsweep
