#pragma once

#include <span>
#include <string>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/sweep/measured_error.hpp"

namespace trebsweep {

/// Reasons to doubt the result of a complete sweep, a line for each: an optimum on the edge of the
/// lattice, and among the checked designs those whose status or speed changes when they are
/// integrated accurately, those with an efficiency above 1, and those close to the optimum whose
/// sling would go slack.
std::vector<std::string> warnings(const Job& job, const Lattice& lattice, const Summary& summary,
                                  std::span<const Check> checks);

}  // namespace trebsweep
