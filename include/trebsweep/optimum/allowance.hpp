#pragma once

#include <array>
#include <cstdint>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much a length may be off before 1 % of the objective is lost, m; infinite if it may be
/// off by more than half of it.
struct Allowance {
  double shorter, longer;
};

/// The allowances of r1, r3 and r2, each with the other lengths exact, by swings. Adds the number
/// of designs that it integrates to `integrated`.
std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated);

}  // namespace trebsweep
