#pragma once

#include <string>

#include "trebsweep/optimum/optimum.hpp"

namespace trebsweep {

/// The result as a JSON object, with the bounds of the parameters and the job with all of its keys,
/// in which the variables have their values at the optimum. Numbers that do not exist are null.
std::string to_json(const OptimumResult& result, const Job& job);

}  // namespace trebsweep
