#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5.h>
#include <unistd.h>

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
#include <system_error>
#include <thread>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/cli/command_line.hpp"
#include "trebsweep/cli/commands.hpp"
#include "trebsweep/cli/dry_run.hpp"
#include "trebsweep/cli/exit_code.hpp"
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
         std::none_of(arguments.begin(), arguments.end(), is("--help-keys")) &&
         std::none_of(arguments.begin(), arguments.end(), is("-h"));
}

/// Aborts all ranks after a failure of one. Neither MPI nor HDF5 is finalized: HDF5 1.10 crashes
/// there after a failed write.
[[noreturn]] void abort_all_ranks(const std::exception& error, const std::string& prefix) {
  std::fflush(stdout);  // what was printed before the failure
  print_message(fmt::format("trebsweep: {}{}\n", prefix, error.what()));
  MPI_Abort(MPI_COMM_WORLD, exit_code::failed.code);
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

/// Reports that stdout could not be written, and why. Returns the exit code.
int report_stdout(const std::error_code& why) {
  if (why == std::errc::broken_pipe) {  // as for `trebsweep trace ... | head`: ends silently, like
                                        // other programs
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  print_message(fmt::format("trebsweep: cannot write to stdout: {}\n", why.message()));
  return exit_code::failed.code;
}

/// Runs a command and returns the exit code: that of the command, `failed` if stdout could not be
/// written, or `refused` for an InputError, which is printed if `print_error`.
template <class Run>
int exit_code_of(bool print_error, Run run) {
  try {
    const int code = run();
    print_result("");  // reports what the buffer still holds
    return code;
  } catch (const OutputError& error) {
    return report_stdout(error.code());
  } catch (const InputError& error) {
    if (print_error) print_message(fmt::format("trebsweep: {}\n", printable(error.what())));
    return exit_code::refused.code;
  }
}

/// Runs a command in one process, without MPI. Returns the exit code.
int serial_main(int argc, char** argv) {
  try {
    return exit_code_of(
        true, [&] { return run_serial(parse_command_line(argc, argv)), exit_code::complete.code; });
  } catch (const std::exception& error) {
    const auto* failure = dynamic_cast<const std::system_error*>(&error);
    if (failure && std::ferror(stdout)) return report_stdout(failure->code());
    std::fflush(stdout);  // what was printed before the failure
    print_message(fmt::format("trebsweep: {}\n", error.what()));
    return exit_code::failed.code;
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
    return exit_code_of(rank == 0, [&] {
      const CommandLine line = parse_command_line(argc, argv);
      const std::string command = fmt::format("{}", fmt::join(std::span(argv, argv + argc), " "));
      if (line.dry_run) return run_dry(line), exit_code::complete.code;
      if (signals) return run_sweep(line, command, *signals);
      if (line.command == Command::optimum) return run_optimum(line);
      return run_assess(line, command), exit_code::complete.code;
    });
  } catch (const mpi::RootError& error) {
    if (rank == 0) abort_all_ranks(error, "");
    MPI_Barrier(MPI_COMM_WORLD);  // until rank 0 aborts
    return exit_code::failed.code;
  }
}

/// Keeps descriptors 0 to 2 from becoming those of other files, such as an archive, if they are
/// closed. Reading and writing them fails as before.
void occupy_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0)
      static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_descriptors();
  std::signal(SIGPIPE, SIG_IGN);  // a message that nobody reads must not end the program
  // HDF5's own locks have hung on network file systems. FileLock excludes concurrent sweeps.
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  H5dont_atexit();  // where HDF5 crashes after a failed write
  const bool parallel = is_parallel(std::span(argv, argv + argc));
  return parallel ? parallel_main(argc, argv) : serial_main(argc, argv);
}
