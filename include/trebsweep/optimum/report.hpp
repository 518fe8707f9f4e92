#pragma once

#include <string>
#include <vector>

#include "trebsweep/job/unit.hpp"
#include "trebsweep/optimum/optimum.hpp"

namespace trebsweep {

/// The job with the optimum's values of its variables.
Job found_job(const OptimumResult& result, const Job& job);

/// In what the optimum of a found_job() cannot be built, and whether it misses a target, as with
/// minimize = abs(range - 50).
std::vector<std::string> warnings(const OptimumResult& result, const Job& job,
                                  UnitSystem units = UnitSystem::si);

/// The result as lines of text for the user. Keys of the scene are shown as in a job file.
std::string to_text(const OptimumResult& result, const Job& job, UnitSystem units = UnitSystem::si);

}  // namespace trebsweep
