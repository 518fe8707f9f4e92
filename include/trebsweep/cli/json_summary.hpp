#pragma once

#include <nlohmann/json.hpp>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The summary of a sweep as a JSON object: the numbers of its text, unrounded and in SI units, and
/// the optimum of every scene. What does not exist is null.
nlohmann::ordered_json to_json(const Summary& summary, const Job& job);

}  // namespace trebsweep
