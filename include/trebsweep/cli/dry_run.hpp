#pragma once

#include "trebsweep/cli/command_line.hpp"

namespace trebsweep {

/// Prints what a sweep, a search or an assessment will cost, and writes no file. Collective. Throws
/// InputError, after it has printed the cost of a sweep, if the command would be refused.
void run_dry(const CommandLine& line);

}  // namespace trebsweep
