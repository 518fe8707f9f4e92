#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/optimum/design_problem.hpp"

namespace trebsweep {

/// By how much a parameter, or the angle of a pin, may be off before 1 % of the objective's
/// magnitude is lost or a limit is passed; infinite if it may be off by more than half of its
/// value, or 1 rad.
struct Allowance {
  double less, more;
  /// What ends it: a constraint or a bound as in limits(), or "no release"; empty for the loss of
  /// 1 %, or if nothing does.
  std::string less_limit{}, more_limit{};
};

/// The allowances of all parameters, each with the others exact, by swings. The value of a fixed
/// length is not a bound: it may still be built wrongly. Adds the number of designs that it
/// integrates to `integrated`.
std::vector<Allowance> allowances(const DesignProblem& problem, const Parameters& parameters,
                                  std::uint64_t& integrated);

/// The allowance of the angle of the pin that makes the release of a design; nothing if no pin
/// does.
std::optional<Allowance> pin_allowance(const DesignProblem& problem, const Parameters& parameters,
                                       std::uint64_t& integrated);

}  // namespace trebsweep
