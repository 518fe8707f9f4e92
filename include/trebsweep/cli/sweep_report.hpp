#pragma once

#include <string>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The summary of a sweep as lines of text for the user, without a newline after the last. Of a
/// study with a table of its scenes, the best first: all of at most 20 scenes, otherwise the ten
/// best and the worst.
std::string to_text(const Summary& summary, const Job& job);

}  // namespace trebsweep
