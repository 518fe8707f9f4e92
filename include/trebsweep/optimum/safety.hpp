#pragma once

#include <cstdint>
#include <optional>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much each parameter may be off: a length by optimum.deviation or, if that is zero, by 0.1
/// %, and a variable by 0.1 % or, if its value is close to zero, of its scale.
Parameters tolerated(const DesignSpace& space, const Parameters& parameters, double deviation);

/// Whether parameters are safe to build: where all lengths, or one variable, are off by what is
/// tolerated(), the objective exists and has no jump larger than 0.1 % of its magnitude, no
/// constraint jumps from satisfied to violated by more than 0.1 % of its scale, and where one
/// parameter is off by 0.05 %, the objective loses less than 2 %. Checked where they are off by
/// half and by all of what is tolerated, lengths at 52 designs, and by bisection between these and
/// the parameters, with swings of that accuracy. Adds the number of designs that it integrates to
/// `integrated`.
bool are_safe(const DesignProblem& problem, const Parameters& parameters, double deviation,
              Accuracy accuracy, std::uint64_t& integrated);

/// Parameters that are_safe() and satisfy the constraints, near others: these themselves or the
/// best of those around them at the smallest distance at which there are any, improved by a pattern
/// search. Returns nothing if none are found within 80 times what is tolerated(), or by the first
/// 30,000 designs that are integrated, after which the search ends. Adds the number of designs that
/// it integrates to `integrated`.
std::optional<Parameters> safe_parameters_near(const DesignProblem& problem,
                                               const Parameters& parameters, double deviation,
                                               std::uint64_t& integrated);

}  // namespace trebsweep
