#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <thread>

#include "trebsweep/assess/assess.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/cli/command_line.hpp"
#include "trebsweep/cli/info.hpp"
#include "trebsweep/cli/stop_signals.hpp"
#include "trebsweep/cli/trace.hpp"
#include "trebsweep/job/load_job.hpp"
#include "trebsweep/sweep/sweep.hpp"
#include "trebsweep/sweep/warnings.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace {

using namespace trebsweep;

constexpr int stopped_before_the_end = 75;  // EX_TEMPFAIL: trying again helps

void print_summary(const Summary& summary, const Job& job) {
  const int ranks = mpi::size(MPI_COMM_WORLD);
  fmt::print("scene     {}\nsolver    {}\n{} on {} {}\narchive   {}\n", scene_text(job),
             solver_text(job.solver), to_text(summary, job.output.optimum_filter), ranks,
             ranks == 1 ? "rank" : "ranks", job.output.file);
}

void print_warnings(const Job& job, const Summary& summary, const std::function<bool()>& stop) {
  const Lattice lattice(job.scene, job.lattice);
  for (const std::string& line : warnings(job, lattice, summary, stop, MPI_COMM_WORLD))
    if (mpi::rank(MPI_COMM_WORLD) == 0) fmt::print(stderr, "warning: {}\n", line);
}

/// Returns the exit code.
int run_sweep(const CommandLine& line, const std::string& command, const StopSignals& signals) {
  const double deadline = MPI_Wtime() + line.time_limit;
  const Job job = load_job(line.job_file, line.overrides, MPI_COMM_WORLD);
  const auto stop = [&] { return signals.requested() || MPI_Wtime() >= deadline; };
  const SweepOptions options{
      .overwrite = line.overwrite, .progress = line.progress, .command = command, .stop = stop};
  const auto summary = sweep(job, options, MPI_COMM_WORLD);
  const bool root = mpi::rank(MPI_COMM_WORLD) == 0;
  if (!summary) {
    if (root)
      fmt::print(stderr,
                 "{} holds the complete archive of this job; --overwrite computes it again\n",
                 job.output.file);
    return 0;
  }
  if (summary->complete) {
    if (root) print_summary(*summary, job);
    std::fflush(stdout);  // a failure is seen at the end
    print_warnings(job, *summary, stop);
    return 0;
  }
  if (root && summary->partial_created)
    fmt::print(stderr, "trebsweep: stopped with {} designs done; the same command continues{}\n",
               summary->designs(), line.overwrite ? ", without --overwrite" : "");
  else if (root)
    fmt::print(
        stderr,
        "trebsweep: stopped with 0 designs done, before the archive was created; the same command "
        "continues if it has more time\n");
  return stopped_before_the_end;
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

/// A command that all ranks run together. Returns the exit code.
int run_parallel(int argc, char** argv, const std::optional<StopSignals>& signals) {
  const CommandLine line = parse_command_line(argc, argv);
  const std::string command = fmt::format("{}", fmt::join(std::span(argv, argv + argc), " "));
  if (signals) return run_sweep(line, command, *signals);
  Job job = load_job(line.job_file, line.overrides, MPI_COMM_WORLD);
  for (const auto& [name, value] : line.overrides)
    if (!name.starts_with("assess.") && !name.starts_with("output."))
      job.assess.overrides[name] = value;
  run_assess(line, job, command);
  return 0;
}

/// A command of one process.
void run_serial(int argc, char** argv) {
  const CommandLine line = parse_command_line(argc, argv);
  switch (line.command) {
    case Command::help:
      return fmt::print("{}", line.help);
    case Command::version:
      return fmt::print("{}\nkernel: {}\n", version_text(), instruction_set());
    case Command::info:
      return fmt::print("{}", describe_archive(line.archive));
    case Command::trace:
      return run_trace(line, load_job(line.job_file, line.overrides));
    case Command::sweep:
    case Command::assess:
      throw InputError(fmt::format("{}: give a job file of that name as ./{}",
                                   shortened(line.job_file), shortened(line.job_file)));
  }
}

/// Whether the command needs MPI, which takes a third of a second to start: sweep and assess, but
/// not their help.
bool is_parallel(std::span<char*> arguments) {
  const auto is = [](std::string_view word) {
    return [=](const char* argument) { return argument == word; };
  };
  return arguments.size() > 1 && (is("sweep")(arguments[1]) || is("assess")(arguments[1])) &&
         std::none_of(arguments.begin(), arguments.end(), is("--help")) &&
         std::none_of(arguments.begin(), arguments.end(), is("-h"));
}

/// Whether a launcher (of Open MPI, MPICH or Slurm) has started this process as a rank other than
/// 0.
bool is_other_rank() {
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"})
    if (const char* rank = std::getenv(name)) return rank != std::string_view("0");
  return false;
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

/// Runs f, which returns the exit code. An error in the user's input is printed if `tell`.
template <class F>
int exit_code(bool tell, F f) {
  try {
    const int code = f();
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    std::perror("trebsweep: cannot write to stdout");
    return 1;
  } catch (const InputError& error) {
    if (tell) fmt::print(stderr, "trebsweep: {}\n", printable(error.what()));
    return 2;
  }
}

/// Returns the exit code.
int serial_main(int argc, char** argv) {
  try {
    return exit_code(true, [&] { return run_serial(argc, argv), 0; });
  } catch (const std::runtime_error& error) {
    fmt::print(stderr, "trebsweep: {}\n", error.what());
    return 1;
  }
}

/// Returns the exit code.
int parallel_main(int argc, char** argv) {
  // A signal may come while MPI starts.
  std::optional<StopSignals> signals;
  if (argv[1] == std::string_view("sweep")) signals.emplace();
  const mpi::Environment environment(argc, argv);
  // Failures of one rank are not caught: unwinding would close the archive, which waits for all
  // ranks, while the others are elsewhere.
  std::set_terminate(end_after_failure);
  const int rank = mpi::rank(MPI_COMM_WORLD);
  try {
    // An InputError is thrown on every rank; rank 0 prints it.
    return exit_code(rank == 0, [&] { return run_parallel(argc, argv, signals); });
  } catch (const mpi::RootError& error) {
    if (rank == 0) end_all_ranks(error, "");
    MPI_Barrier(MPI_COMM_WORLD);  // until rank 0 ends it
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  // HDF5's own locks would let somebody who looks at an unfinished archive keep its sweep from
  // going on, and have hung on network file systems; sweeps keep each other out by a FileLock.
  setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
  if (is_parallel(std::span(argv, argv + argc))) return parallel_main(argc, argv);
  return is_other_rank() ? 0 : serial_main(argc, argv);
}
