#pragma once

#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/optimum.hpp"

namespace trebsweep {

/// Adds to a result what is computed at its parameters alone: the value and its error, what a
/// builder needs to know, derivatives, bounds and allowances and, with a deviation (m), the
/// robustness.
void describe(const DesignProblem& problem, double deviation, OptimumResult& result);

}  // namespace trebsweep
