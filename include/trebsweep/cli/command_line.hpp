#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/unit.hpp"
#include "trebsweep/optimum/pareto_spec.hpp"

namespace trebsweep {

enum class Command { sweep, optimum, trace, assess, info, text, version };

/// The commands that take a file, in the order of Command.
inline constexpr std::array<std::string_view, 5> command_names{"sweep", "optimum", "trace",
                                                               "assess", "info"};

/// A parsed command line.
struct CommandLine {
  Command command = Command::text;
  std::string text;                ///< of Command::text: what is printed, such as help
  std::string file;                ///< the archive of Command::info, otherwise the job file
  Overrides overrides;             ///< keys of the job file given as options
  std::vector<std::string> unset;  ///< keys of the job file that it does as if it did not set
  bool overwrite = false;
  bool dry_run = false;
  bool verify = false;   ///< of Command::info
  std::string snapshot;  ///< of Command::info: the file to write; empty if none
  bool json = false;
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
