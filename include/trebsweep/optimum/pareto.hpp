#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "trebsweep/optimum/optimum.hpp"
#include "trebsweep/optimum/pareto_spec.hpp"

namespace trebsweep {

/// A point of a Pareto front: the optimum of the first objective where the second has a lower
/// limit.
struct ParetoPoint {
  OptimumResult result;
  double first, second;  ///< the objectives
  double multiplier;     ///< d first / d second along the front; NaN at its ends, or if not known
};

/// The Pareto front of a job: searches for the largest value of each objective, and of the first
/// one at equal distances of the second between them, each from the last point as well. Levels at
/// which nothing is found are left out. In ascending order of the second objective, on rank 0.
/// Throws InputError if the scene does not have an objective, NoOptimum as find_optimum().
/// Collective.
std::vector<ParetoPoint> pareto_front(const Job& job, const ParetoSpec& spec,
                                      const OptimumOptions& options, MPI_Comm comm);

/// The front as a table, and as a JSON object with its points and the job.
std::string to_text(const std::vector<ParetoPoint>& front, const ParetoSpec& spec, const Job& job,
                    UnitSystem units = UnitSystem::si);
std::string to_json(const std::vector<ParetoPoint>& front, const ParetoSpec& spec, const Job& job);

}  // namespace trebsweep
