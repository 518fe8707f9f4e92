#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <span>
#include <string_view>
#include <thread>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/cli/command_line.hpp"
#include "trebsweep/cli/commands.hpp"
#include "trebsweep/cli/stop_signals.hpp"

namespace {

using namespace trebsweep;

/// Whether the command needs MPI: sweep, optimum and assess, but not their help. Starting MPI takes
/// a third of a second.
bool is_parallel(std::span<char*> arguments) {
  const auto is = [](std::string_view word) {
    return [=](const char* argument) { return argument == word; };
  };
  constexpr std::array<std::string_view, 3> parallel{"sweep", "optimum", "assess"};
  return arguments.size() > 1 && std::ranges::count(parallel, arguments[1]) > 0 &&
         std::none_of(arguments.begin(), arguments.end(), is("--help")) &&
         std::none_of(arguments.begin(), arguments.end(), is("-h"));
}

/// Whether a launcher (of Open MPI, MPICH or Slurm) started this process as a rank other than 0.
bool is_other_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})
    if (const char* rank = std::getenv(name)) return rank != std::string_view("0");
  return false;
}

/// Aborts all ranks after a failure of one. Neither MPI nor HDF5 is finalized: HDF5 1.10 crashes
/// there after a failed write.
[[noreturn]] void abort_all_ranks(const std::exception& error, const std::string& prefix) {
  std::fflush(stdout);  // what was printed before the failure
  fmt::print(stderr, "trebsweep: {}{}\n", prefix, error.what());
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

/// The terminate handler: reports an exception that was not caught, and aborts all ranks.
[[noreturn]] void report_and_abort() {
  const int rank = mpi::rank(MPI_COMM_WORLD);
  // Most failures affect many ranks at once. Each waits in turn, so that only the first one reports
  // before it aborts the others.
  std::signal(SIGTERM, SIG_DFL);
  std::this_thread::sleep_for(std::chrono::milliseconds(500) * std::min(rank, 6));
  try {
    std::rethrow_exception(std::current_exception());
  } catch (const std::exception& error) {
    abort_all_ranks(error, fmt::format("rank {}: ", rank));
  }
}

/// Runs a command and returns the exit code: that of the command, 1 if stdout could not be written,
/// or 2 for an InputError, which is printed if `print_error`.
template <class Run>
int exit_code(bool print_error, Run run) {
  try {
    const int code = run();
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    std::perror("trebsweep: cannot write to stdout");
    return 1;
  } catch (const InputError& error) {
    if (print_error) fmt::print(stderr, "trebsweep: {}\n", printable(error.what()));
    return 2;
  }
}

/// Runs a command in one process, without MPI. Returns the exit code.
int serial_main(int argc, char** argv) {
  try {
    return exit_code(true, [&] { return run_serial(parse_command_line(argc, argv)), 0; });
  } catch (const std::exception& error) {
    std::fflush(stdout);  // what was printed before the failure
    fmt::print(stderr, "trebsweep: {}\n", error.what());
    return 1;
  }
}

/// Runs a command on all ranks. Returns the exit code.
int parallel_main(int argc, char** argv) {
  // Before MPI starts, because a signal may arrive while it does.
  std::optional<StopSignals> signals;
  if (argv[1] == std::string_view("sweep")) signals.emplace();
  const mpi::Environment environment(argc, argv);
  // Failures of one rank are not caught: unwinding would close the archive, a collective operation
  // in which this rank would wait for the others forever.
  std::set_terminate(report_and_abort);
  const int rank = mpi::rank(MPI_COMM_WORLD);
  try {
    // Every rank throws an InputError; rank 0 prints it.
    return exit_code(rank == 0, [&] {
      const CommandLine line = parse_command_line(argc, argv);
      const std::string command = fmt::format("{}", fmt::join(std::span(argv, argv + argc), " "));
      if (signals) return run_sweep(line, command, *signals);
      if (line.command == Command::optimum) return run_optimum(line);
      return run_assess(line, command), 0;
    });
  } catch (const mpi::RootError& error) {
    if (rank == 0) abort_all_ranks(error, "");
    MPI_Barrier(MPI_COMM_WORLD);  // until rank 0 aborts
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  // With HDF5's own locks a reader of a partial archive would block the sweep that continues it,
  // and they have hung on network file systems. FileLock excludes concurrent sweeps instead.
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  if (is_parallel(std::span(argv, argv + argc))) return parallel_main(argc, argv);
  // Without MPI only rank 0 runs the command.
  return is_other_rank() ? 0 : serial_main(argc, argv);
}
