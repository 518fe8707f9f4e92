#pragma once

#include <span>
#include <string>

#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The optima of a study's scenes as a table for the user, the largest value first, without a
/// newline after the last line: all of at most 20 scenes, otherwise the ten best and the worst.
/// Scenes without an optimum are counted, together with those not done unless the sweep is
/// complete.
std::string scene_table(const Job& job, std::span<const SceneOptimum> optima, bool complete);

}  // namespace trebsweep
