#pragma once

#include <boost/program_options/options_description.hpp>

#include "trebsweep/cli/command_line.hpp"
#include "trebsweep/job/key.hpp"

namespace trebsweep {

/// The options of a command, except for the keys of the job file.
boost::program_options::options_description command_options(Command command);

/// The same with -o, the short name of output.file, where the command uses it.
boost::program_options::options_description shown_options(Command command);

/// Whether a command uses a key of the job file.
bool uses(Command command, const Key& key);

/// The keys of the job file that a command uses, as options, in a group per section.
boost::program_options::options_description key_options(Command command);

}  // namespace trebsweep
