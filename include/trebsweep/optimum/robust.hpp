#pragma once

#include <cstdint>
#include <optional>

#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/local_search.hpp"

namespace trebsweep {

/// The objective over the box of lengths that are off by up to a deviation each: r1, r3 and r2,
/// fixed ones included, and variables in metres. NaN if a design in the box has no release.
struct Robustness {
  double worst;     ///< the smallest value
  double expected;  ///< the mean, by Gauss-Legendre quadrature with seven nodes per length, or
                    ///< three of more than three lengths
  std::optional<Parameters> unreleased;  ///< some in the box that have no release
};

/// `deviation` is in metres. Adds the number of designs that it integrates to `integrated`.
Robustness robustness(const DesignProblem& problem, const Parameters& parameters, double deviation,
                      std::uint64_t& integrated);

/// The part of a design space whose designs may be off by a deviation (m) without a length that is
/// impossible in a scene of the job (47).
DesignSpace robust_space(const Job& job, DesignSpace space, double deviation);

/// The design near `start` with the best worst case or the best expected value, such that all
/// designs within the deviation satisfy the constraints. Its multipliers are those of the nominal
/// program's constraints. The worst cases are those of the vertices of the box and of deviations
/// that are found to be worse, where constraints are checked as well (exchange method).
KktPoint robust_search(const DesignProblem& problem, const Parameters& start, Robust robust,
                       double deviation, std::uint64_t& integrated);

}  // namespace trebsweep
