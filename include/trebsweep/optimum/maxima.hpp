#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/swing_parts.hpp"

namespace trebsweep {

/// A local maximum of the objective, under the constraints.
struct LocalMaximum {
  Parameters parameters;
  double value;
  std::uint64_t starts;  ///< number of searches that reached it
  bool converged;
};

/// The end of a search, in the variables of the nonlinear program.
struct Found {
  std::array<double, length_count + max_variables> x;
  double objective, violation;
  bool converged;
  std::uint64_t integrated;
};

/// A search from parameters, which adds the number of designs that it integrates to `integrated`.
using Search = std::function<ProblemOptimum(const Parameters& start, std::uint64_t& integrated)>;

/// Searches from several parameters, each on one of the ranks, and returns the feasible ends, best
/// first. Adds to `integrated`. Collective.
std::vector<Found> find_maxima(const std::vector<Parameters>& starts, const Search& search,
                               ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated);

/// Adds the feasible ends of other searches, so that the best comes first.
void merge(std::vector<Found>& found, const std::vector<Found>& more);

/// The same by the nominal program of a problem: quick searches, and without variables thorough
/// ones from the best ends of those that did not converge, unless they are far below the best of
/// those that did.
std::vector<Found> find_maxima(const std::vector<Parameters>& starts, const DesignProblem& problem,
                               ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated);

/// The distinct ones of sorted ends of searches, each with the number of searches that ended there.
std::vector<LocalMaximum> distinct(const std::vector<Found>& found, const DesignProblem& problem);

}  // namespace trebsweep
