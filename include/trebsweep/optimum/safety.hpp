#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much each length may be off at a design, m: by optimum.deviation or, if that is zero, by
/// 0.1 % of the length.
std::array<double, 3> tolerated(const Design<double>& design, double deviation);

/// Whether a design is safe to build: where all lengths are off by up to what is tolerated(), the
/// objective exists and has no jump larger than 0.1 % of its value, no constraint jumps from
/// satisfied to violated by more than 0.1 % of its scale, and where one length is off by 0.05 %,
/// the objective loses less than 2 %. Checked at 52 designs, with all lengths off by half and by
/// all of what is tolerated, and by bisection between them and the design. Adds the number of
/// designs that it integrates to `integrated`.
bool is_safe(const DesignProblem& problem, const Design<double>& design, double deviation,
             std::uint64_t& integrated);

/// A design that is_safe() and satisfies the constraints, near one that is not safe: the best of
/// those around it at the smallest distance at which there is one, improved by a pattern search.
/// Returns nothing if no such design is found within 80 times what is tolerated().
std::optional<Design<double>> safe_design_near(const DesignProblem& problem,
                                               const Design<double>& design, double deviation,
                                               std::uint64_t& integrated);

}  // namespace trebsweep
