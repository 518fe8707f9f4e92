#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much a length (m) or an angle (rad) may be off before 1 % of the objective is lost or a
/// limit is passed; infinite if it may be off by more than half of a length, or 1 rad.
struct Allowance {
  double less, more;
  /// What ends it: a constraint or a bound as in limits(), or "no release"; empty for the loss of
  /// 1 %, or if nothing does.
  std::string less_limit{}, more_limit{};
};

/// The allowances of r1, r3 and r2, each with the other lengths exact, by swings. The value of a
/// fixed length is not a bound: it may still be built wrongly. Adds the number of designs that it
/// integrates to `integrated`.
std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated);

/// The allowance of the angle of the pin that makes the release of a design; nothing if no pin
/// does.
std::optional<Allowance> pin_allowance(const DesignProblem& problem, const Design<double>& design,
                                       std::uint64_t& integrated);

}  // namespace trebsweep
