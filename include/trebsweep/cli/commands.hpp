#pragma once

#include <string>

#include "trebsweep/cli/command_line.hpp"
#include "trebsweep/cli/stop_signals.hpp"

namespace trebsweep {

/// Runs `trebsweep sweep` and returns the exit code. `command` is the command line as typed.
/// Collective; throws InputError and mpi::RootError on all ranks.
int run_sweep(const CommandLine& line, const std::string& command, const StopSignals& signals);

/// The job of `trebsweep optimum`, and that of `trebsweep assess`. Collective; throw InputError on
/// all ranks.
Job load_search(const CommandLine& line);
Job load_assessment(const CommandLine& line);

/// Runs `trebsweep optimum` and returns the exit code. Collective; throws InputError on all ranks.
int run_optimum(const CommandLine& line);

/// Runs `trebsweep assess`. `command` is the command line as typed. Collective; throws InputError
/// and mpi::RootError on all ranks.
void run_assess(const CommandLine& line, const std::string& command);

/// Runs a command that takes one process: help, version, info or trace. Throws InputError, and
/// std::runtime_error if an archive cannot be read or is damaged.
void run_serial(const CommandLine& line);

}  // namespace trebsweep
