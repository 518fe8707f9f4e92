#pragma once

#include <limits>
#include <optional>
#include <string>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/unit.hpp"
#include "trebsweep/optimum/pareto_spec.hpp"

namespace trebsweep {

enum class Command { help, version, sweep, optimum, trace, assess, info };

/// A parsed command line.
struct CommandLine {
  Command command = Command::help;
  std::string help;     ///< of Command::help: the text to print
  std::string file;     ///< the archive of Command::info, otherwise the job file
  Overrides overrides;  ///< keys of the job file given as options
  bool overwrite = false;
  bool verify = false;                ///< of Command::info
  std::string snapshot;               ///< of Command::info: the file to write; empty if none
  bool json = false;                  ///< of Command::optimum
  std::optional<ParetoSpec> pareto;   ///< of Command::optimum
  UnitSystem units = UnitSystem::si;  ///< of Command::optimum
  ProgressStyle progress = ProgressStyle::automatic;
  double time_limit = std::numeric_limits<double>::infinity();  ///< s, of Command::sweep
  Design<double> design{};                                      ///< of Command::trace
  std::optional<double> interval;                               ///< s, of Command::trace
  bool flight = false;                                          ///< of Command::trace
};

/// Throws InputError.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace trebsweep
