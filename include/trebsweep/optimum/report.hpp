#pragma once

#include <string>
#include <vector>

#include "trebsweep/optimum/optimum.hpp"

namespace trebsweep {

/// The job with the optimum's values of its variables.
Job found_job(const OptimumResult& result, const Job& job);

/// In what the optimum of a found_job() cannot be built, and whether it misses a target, as with
/// minimize = abs(range - 50).
std::vector<std::string> warnings(const OptimumResult& result, const Job& job);

/// The result as lines of text for the user.
std::string to_text(const OptimumResult& result, const Job& job);

}  // namespace trebsweep
