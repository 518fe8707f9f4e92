#pragma once

#include <string>

#include "trebsweep/cli/command_line.hpp"

namespace trebsweep {

/// The output of `trebsweep --help`.
std::string general_help();

/// The output of `trebsweep COMMAND --help`: the usage, what the command does, its options and the
/// keys of the job file that it uses.
std::string command_help(Command command);

}  // namespace trebsweep
