#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much a length may be off before 1 % of the objective is lost or a limit is passed, m;
/// infinite if it may be off by more than half of it.
struct Allowance {
  double shorter, longer;
  /// What ends it: a constraint or a bound as in limits(), or "no release"; empty for the loss of
  /// 1 %, or if nothing does.
  std::string shorter_limit{}, longer_limit{};
};

/// The allowances of r1, r3 and r2, each with the other lengths exact, by swings. The value of a
/// fixed length is not a bound: it may still be built wrongly. Adds the number of designs that it
/// integrates to `integrated`.
std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated);

}  // namespace trebsweep
