#pragma once

#include <string>
#include <vector>

#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/sweep.hpp"

namespace trebsweep {

/// Reasons to doubt the result of a complete sweep, a line for each: an optimum that cannot be
/// built or lies on the edge of the lattice, and among the checked designs those whose status or
/// speed changes when they are integrated accurately, those with an efficiency above 1, and, unless
/// that of the optimum does, those close to it whose sling would go slack.
///
/// Of a study, those of the scene of the optimum; how many of the other checked scenes have some,
/// with an example; and in how many scenes the optimum cannot be built, and in how many it lies on
/// the edge of the lattice.
std::vector<std::string> warnings(const Study& study, const SweepResult& result);

}  // namespace trebsweep
