#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <string_view>
#include <thread>

#include "trebsweep/assess.hpp"
#include "trebsweep/command_line.hpp"
#include "trebsweep/error.hpp"
#include "trebsweep/info.hpp"
#include "trebsweep/kernel.hpp"
#include "trebsweep/load_job.hpp"
#include "trebsweep/mpi.hpp"
#include "trebsweep/stop_signals.hpp"
#include "trebsweep/sweep.hpp"
#include "trebsweep/trace.hpp"
#include "trebsweep/version.hpp"

namespace {

using namespace trebsweep;

constexpr int stopped_before_the_end = 75;  // EX_TEMPFAIL: trying again helps

void print_summary(const Summary& summary, const Job& job) {
  const int ranks = mpi::size(MPI_COMM_WORLD);
  fmt::print("{} on {} {}\narchive   {}\n", to_text(summary, job.output.contest), ranks,
             ranks == 1 ? "rank" : "ranks", job.output.file);
}

/// Returns the exit code.
int run_sweep(const CommandLine& line, const std::string& command) {
  const double deadline = MPI_Wtime() + line.time_limit;
  const StopSignals signals;
  const Job job = load_job(line.job_file, line.overrides, MPI_COMM_WORLD);
  const SweepOptions options{
      .overwrite = line.overwrite, .progress = line.progress, .command = command, .stop = [&] {
        return signals.came() || MPI_Wtime() >= deadline;
      }};
  const auto summary = sweep(job, options, MPI_COMM_WORLD);
  const int code = summary && !summary->complete ? stopped_before_the_end : 0;
  if (mpi::rank(MPI_COMM_WORLD) != 0) return code;
  if (code != 0)
    fmt::print(stderr, "trebsweep: stopped with {} designs done; the same command continues{}\n",
               summary->designs(), line.overwrite && summary->begun ? ", without --overwrite" : "");
  else if (summary)
    print_summary(*summary, job);
  else
    fmt::print(stderr, "{} holds the complete archive of this job; --overwrite computes it anew\n",
               job.output.file);
  return code;
}

void run_trace(const CommandLine& line, const Job& job) {
  const Status status = trace(job, line.design, line.interval, stdout);
  if (status != Status::released)
    fmt::print(stderr, "the swing ends without a release: {}\n",
               status_names[static_cast<std::size_t>(status)]);
}

void run_assess(const CommandLine& line, const Job& job, const std::string& command) {
  const AssessOptions options{.overwrite = line.overwrite,
                              .progress = line.progress != ProgressStyle::none,
                              .command = command};
  const auto tables = assess(job, options, MPI_COMM_WORLD);
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  for (const Table& table : tables)
    if (const std::string text = to_text(table); !text.empty()) fmt::print("{}\n", text);
  fmt::print("archive   {}\n", job.output.file);
}

/// Returns the exit code.
int run(int argc, char** argv) {
  const CommandLine line = parse_command_line(argc, argv);
  const bool root = mpi::rank(MPI_COMM_WORLD) == 0;
  if (line.command == Command::help || line.command == Command::version) {
    if (root && line.command == Command::help) fmt::print("{}", line.help);
    if (root && line.command == Command::version)
      fmt::print("{}\nkernel: {}\n", version_text(), instruction_set());
    return 0;
  }
  const std::string command = fmt::format("{}", fmt::join(std::span(argv, argv + argc), " "));
  if (line.command == Command::sweep) return run_sweep(line, command);
  const Job job = load_job(line.job_file, line.overrides, MPI_COMM_WORLD);
  if (line.command == Command::assess)
    run_assess(line, job, command);
  else if (root)
    run_trace(line, job);
  return 0;
}

/// Ends all ranks after a failure of one. Neither MPI nor HDF5 is finalized: after a failed write
/// HDF5 1.10 crashes there.
[[noreturn]] void end_all_ranks(const std::exception& error, const std::string& who) {
  fmt::print(stderr, "trebsweep: {}{}\n", who, error.what());
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

/// For failures that are not caught.
[[noreturn]] void end_after_failure() {
  const int rank = mpi::rank(MPI_COMM_WORLD);
  // Most failures come to many ranks at once: they wait in turn, and the first one ends the others.
  std::signal(SIGTERM, SIG_DFL);
  std::this_thread::sleep_for(std::chrono::milliseconds(500) * std::min(rank, 6));
  try {
    std::rethrow_exception(std::current_exception());
  } catch (const std::exception& error) {
    end_all_ranks(error, fmt::format("rank {}: ", rank));
  }
}

/// Runs f, which returns the exit code; a failure that is the user's is told, if `tell`.
template <class F>
int exit_code(bool tell, F f) {
  try {
    const int code = f();
    if (std::fflush(stdout) == 0) return code;
    std::perror("trebsweep: cannot write to stdout");
    return 1;
  } catch (const InputError& error) {
    if (tell) fmt::print(stderr, "trebsweep: {}\n", error.what());
    return 2;
  }
}

/// A command that needs no MPI: it works on a login node, too.
int run_info(int argc, char** argv) {
  const auto print = [&] {
    const CommandLine line = parse_command_line(argc, argv);
    fmt::print("{}", line.command == Command::help ? line.help : describe_archive(line.archive));
    return 0;
  };
  try {
    return exit_code(true, print);
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "trebsweep: {}\n", error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  // HDF5's own locks would let somebody who looks at an unfinished archive keep its sweep from
  // going on, and have hung on network file systems; sweeps keep each other out by a FileLock.
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  if (argc > 1 && argv[1] == std::string_view("info")) return run_info(argc, argv);
  const mpi::Environment environment(argc, argv);
  // Failures of one rank are not caught: unwinding would close the archive, which waits for all
  // ranks, while the others are elsewhere.
  std::set_terminate(end_after_failure);
  const int rank = mpi::rank(MPI_COMM_WORLD);
  try {
    // Every rank comes to the same failure; one tells it.
    return exit_code(rank == 0, [&] { return run(argc, argv); });
  } catch (const mpi::RootError& error) {
    if (rank == 0) end_all_ranks(error, "");
    MPI_Barrier(MPI_COMM_WORLD);  // until rank 0 ends it
    return 1;
  }
}
