#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/local_search.hpp"

namespace trebsweep {

// The largest load of a swing has a kink as a function of the design where two of its peaks are
// equal, and least loads tend to be there. The largest load of a part of the swing, with one of the
// peaks, has none.

/// What a part of the swing contributes to the conditions of Karush, Kuhn and Tucker.
struct PartOptimum {
  DesignProblem problem;        ///< whose extremes are those of the part
  double weight;                ///< of its objective; those of all parts add up to one
  Eigen::VectorXd derivatives;  ///< of the optimum with respect to its limits()
};

/// A local optimum of a problem, and the parts of the swing, whose derivatives add up: one, the
/// whole swing, unless extremes are equal at a kink.
struct ProblemOptimum {
  Point point;
  bool converged;
  std::vector<PartOptimum> parts;
};

/// The optimum of a problem that is its only part.
ProblemOptimum undivided(const DesignProblem& problem, const KktPoint& found);

/// Problems that differ from one in the steps that count for extremes: each has one of the extremes
/// that come close to the objective or to a limit at some parameters. Returns only the problem
/// itself if there is at most one such extreme, or if the whole swing is not as good as its worst
/// part, as where larger loads are better.
std::vector<DesignProblem> split(const DesignProblem& problem, const Parameters& parameters,
                                 std::uint64_t& integrated);

/// The local optimum that a search() from parameters reaches. Where that ends at a kink because
/// extremes are equal, the parts of the swing make it converge.
ProblemOptimum search(const DesignProblem& problem, const Parameters& start, Effort effort,
                      std::uint64_t& integrated);

}  // namespace trebsweep
