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

/// The optimum of a scene of a study, from that of its lattice. `job` is that of the scene alone.
/// With optimum.refine, it is the one that `refine` finds, if it finds one. Otherwise it is the
/// best design of the lattice, and its error is the difference of its value from that of
/// integrate_accurately(), or NaN without solver.check.
SceneOptimum scene_optimum(const Job& job, const Optimum& optimum, const Refine& refine);

}  // namespace trebsweep
