#pragma once

#include <span>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/sweep/measured_error.hpp"

namespace trebsweep {

/// Reasons to doubt the result of a complete sweep of one scene, a line for each: an optimum on the
/// edge of the lattice, and among the checked designs those whose status or speed changes when they
/// are integrated accurately, those with an efficiency above 1, and those close to the optimum
/// whose sling would go slack.
std::vector<std::string> warnings(const Job& job, const Lattice& lattice,
                                  const std::optional<Optimum>& optimum,
                                  const std::optional<MeasuredError>& error,
                                  std::span<const Check> checks);

/// The same for a study: those of the scene of the optimum; how many of the other checked scenes
/// have some, with an example; and how many scenes have their optimum on the edge of the lattice.
/// `tallies` are those of the scenes. For rank 0.
std::vector<std::string> warnings(const Study& study, const Summary& summary,
                                  std::span<const Tally> tallies,
                                  std::span<const ErrorSample> samples);

}  // namespace trebsweep
