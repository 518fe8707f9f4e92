#pragma once

#include <string>
#include <string_view>

#include "trebsweep/cli/command_line.hpp"

namespace trebsweep {

/// What help and manual say of a command: how it is called, what it does on a line, and in
/// paragraphs, where indented lines are a table.
struct CommandText {
  std::string_view usage, brief, text;
};

const CommandText& text_of(Command command);

/// What job files and options are, in paragraphs.
std::string job_text();

/// The output of `trebsweep --help`, which fits a screen, as command_help() does: at most 50 lines
/// of at most 100 characters.
std::string general_help();

/// The output of `trebsweep COMMAND --help`: the usage, what the command does, its options and the
/// names of the keys that it uses.
std::string command_help(Command command);

/// The output of `trebsweep COMMAND --help-keys`: the keys of the job file that the command uses.
std::string key_help(Command command);

}  // namespace trebsweep
