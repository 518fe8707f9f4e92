#pragma once

#include <span>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/best_designs.hpp"
#include "trebsweep/sweep/measured_error.hpp"

namespace trebsweep {

/// Reasons to doubt the result of a complete sweep, a line for each: a best design that cannot be
/// built or lies on the edge of the lattice, and among the checked designs those whose status or
/// speed changes when they are integrated accurately, those with an efficiency above 1, and, unless
/// that of the best design does, those close to it whose sling would go slack. `best` has the best
/// design of each scene.
///
/// Of a study, those of the scene of the optimum; how many of the other checked scenes have some,
/// with an example; and in how many scenes the best design cannot be built, and in how many it lies
/// on the edge of the lattice.
std::vector<std::string> warnings(const Study& study, const Summary& summary,
                                  std::span<const BestDesign> best,
                                  std::span<const ErrorSample> samples);

}  // namespace trebsweep
