#pragma once

#include <limits>
#include <optional>
#include <string>

#include "trebsweep/job/job.hpp"
#include "trebsweep/sweep/progress.hpp"

namespace trebsweep {

enum class Command { help, version, sweep, trace, assess, info };

/// What the user asked for.
struct CommandLine {
  Command command = Command::help;
  std::string help;  ///< text to print, for Command::help
  std::string job_file;
  std::string archive;  ///< for Command::info
  Overrides overrides;
  bool overwrite = false;
  ProgressStyle progress = ProgressStyle::automatic;
  double time_limit = std::numeric_limits<double>::infinity();  ///< s, for Command::sweep
  Design<double> design{};                                      ///< for Command::trace
  std::optional<double> interval;                               ///< s, for Command::trace
};

/// Throws InputError.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace trebsweep
