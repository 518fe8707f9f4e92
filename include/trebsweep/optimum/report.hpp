#pragma once

#include <string>

#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/optimum.hpp"

namespace trebsweep {

/// The result as lines of text for the user.
std::string to_text(const OptimumResult& result, const Job& job);

/// The result as a JSON object, with the bounds of the lengths and the job with all of its keys.
/// Numbers that do not exist are null.
std::string to_json(const OptimumResult& result, const Job& job);

}  // namespace trebsweep
