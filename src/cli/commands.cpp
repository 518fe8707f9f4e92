#include "trebsweep/cli/commands.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <nlohmann/json.hpp>

#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/assess/assess.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/cli/exit_code.hpp"
#include "trebsweep/cli/info.hpp"
#include "trebsweep/cli/json_summary.hpp"
#include "trebsweep/cli/sweep_report.hpp"
#include "trebsweep/cli/trace.hpp"
#include "trebsweep/cli/warnings.hpp"
#include "trebsweep/job/load_job.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/optimum/json_report.hpp"
#include "trebsweep/optimum/pareto.hpp"
#include "trebsweep/optimum/report.hpp"
#include "trebsweep/sweep/sweep.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

bool is_root() { return mpi::rank(MPI_COMM_WORLD) == 0; }

/// Prints the summary of a sweep as a JSON object.
void print_json(const Summary& summary, const Job& job, const std::vector<std::string>& warnings) {
  nlohmann::ordered_json json{
      {"archive", job.output.file}, {"ranks", mpi::size(MPI_COMM_WORLD)}, {"warnings", warnings}};
  json.update(to_json(summary, job));
  print_result(json.dump(2) + "\n");
}

/// Prints the tables of an assessment as a JSON object of objects, with the values of each column.
void print_json(const std::vector<Table>& tables, const Job& job) {
  nlohmann::ordered_json json{{"archive", job.output.file},
                              {"tables", nlohmann::ordered_json::object()}};
  for (const Table& table : tables)
    for (const Column& column : table.columns)
      std::visit([&](const auto& values) { json["tables"][table.name][column.name] = values; },
                 column.values);
  print_result(json.dump(2) + "\n");
}

void print_report(const SweepResult& result, const Study& study) {
  const Job& job = study.job();
  const int ranks = mpi::size(MPI_COMM_WORLD);
  const std::string axes = trough_axes_text(job);
  print_result(fmt::format("scene     {}\n{}solver    {}\n{} on {} {}\narchive   {}\n",
                           scene_text(job), axes.empty() ? "" : "axes      " + axes + "\n",
                           solver_text(job.solver), to_text(result.summary, job), ranks,
                           ranks == 1 ? "rank" : "ranks", job.output.file));
}

/// Tells that there is nothing to do; as JSON, prints the summary of the archive.
void print_complete(const Job& job, bool json) {
  print_message(
      fmt::format("{} holds the complete archive of this job; --overwrite computes it again\n",
                  job.output.file));
  if (json) print_json(read_contents(job.output.file).summary, job, {});
}

void print_stopped(const Summary& summary, bool overwrite) {
  print_message(fmt::format(
      "trebsweep: stopped with {} designs done; the same command continues the sweep{}\n",
      summary.tally.designs(), overwrite ? ", without --overwrite" : ""));
}

void run_trace(const CommandLine& line) {
  const Job job = load_job(line.file, line.overrides, line.unset);
  require_one_scene(job, "trace integrates one scene");
  const auto print = line.flight ? trace_flight : trace;
  const auto [status, problems] = print(job, line.design, line.interval, stdout);
  if (!problems.empty())
    print_message(fmt::format("warning: the design cannot be built: {}\n", to_text(problems)));
  if (status == Status::released_below_ground)
    print_message(fmt::format("no flight: {}: {}\n", name_of(status), meaning_of(status)));
  else if (status != Status::released)
    print_message(fmt::format("the swing ends without a release: {}: {}\n", name_of(status),
                              meaning_of(status)));
}

}  // namespace

int run_sweep(const CommandLine& line, const std::string& command, const StopSignals& signals) {
  const double deadline = MPI_Wtime() + line.time_limit;
  const auto stop = [&] { return signals.requested() || MPI_Wtime() >= deadline; };
  const Study study(load_job(line.file, line.overrides, MPI_COMM_WORLD, line.unset));
  const SweepOptions options{.overwrite = line.overwrite,
                             .progress = line.progress,
                             .command = command,
                             .refine = refine,
                             .stop = stop};
  const auto result = sweep(study, options, MPI_COMM_WORLD);
  if (!result) {
    if (is_root()) print_complete(study.job(), line.json);
    return exit_code::complete.code;
  }
  if (!result->summary.complete) {
    if (is_root()) print_stopped(result->summary, line.overwrite);
    if (is_root() && line.json) print_json(result->summary, study.job(), {});
    return exit_code::stopped.code;
  }
  if (!is_root()) return exit_code::complete.code;
  const auto doubts = warnings(study, *result);
  line.json ? print_json(result->summary, study.job(), doubts) : print_report(*result, study);
  for (const std::string& doubt : doubts) print_message("warning: " + doubt + "\n");
  return exit_code::complete.code;
}

Job load_search(const CommandLine& line) {
  Job job = load_job(line.file, line.overrides, MPI_COMM_WORLD, line.unset);
  require_one_scene(job,
                    "optimum searches in one scene; 'trebsweep sweep JOB --output.maps none "
                    "--optimum.refine yes' finds the optimum of each");
  return job;
}

Job load_assessment(const CommandLine& line) {
  Job job = load_job(line.file, line.overrides, MPI_COMM_WORLD, line.unset, assessment_ending);
  require_one_scene(job, "assess takes one scene from each file");
  for (const auto& [name, value] : line.overrides)
    if (!name.starts_with("assess.") && !name.starts_with("output."))
      job.assess.overrides[name] = value;
  return job;
}

int run_optimum(const CommandLine& line) {
  const Job job = load_search(line);
  const OptimumOptions options{.own_lattice = line.overrides.contains("lattice.increment"),
                               .progress = line.progress};
  try {
    if (line.pareto) {
      const auto front = pareto_front(job, *line.pareto, options, MPI_COMM_WORLD);
      if (is_root())
        print_result(line.json ? to_json(front, *line.pareto, job) + "\n"
                               : to_text(front, *line.pareto, job, line.units));
      return exit_code::complete.code;
    }
    const auto result = find_optimum(job, options, MPI_COMM_WORLD);
    if (is_root())
      print_result((line.json ? to_json(*result, job) : to_text(*result, job, line.units)) + "\n");
    return exit_code::complete.code;
  } catch (const NoOptimum& error) {
    if (is_root()) print_message(fmt::format("trebsweep: {}\n", error.what()));
    return exit_code::nothing_found.code;
  }
}

void run_assess(const CommandLine& line, const std::string& command) {
  const Job job = load_assessment(line);
  const AssessOptions options{.overwrite = line.overwrite,
                              .progress = line.progress != ProgressStyle::none,
                              .command = command,
                              .job_name = job_name(line.file)};
  const auto tables = assess(job, options, MPI_COMM_WORLD);
  if (!is_root()) return;
  if (line.json) return print_json(tables, job);
  for (const Table& table : tables)
    if (const std::string text = to_text(table); !text.empty()) print_result(text + "\n");
  print_result(fmt::format("archive   {}\n", job.output.file));
}

void run_serial(const CommandLine& line) {
  switch (line.command) {
    case Command::text:
      return print_result(line.text);
    case Command::version:
      return print_result(fmt::format("{}\nkernel: {}\n", version_text(), instruction_set()));
    case Command::info:
      if (line.verify) return verify_archive(line.file, line.progress, stdout);
      if (!line.snapshot.empty()) return write_snapshot(line.file, line.snapshot);
      return print_result(describe_archive(line.file, line.json));
    case Command::trace:
      return run_trace(line);
    case Command::sweep:
    case Command::optimum:
    case Command::assess:
      // Only `trebsweep sweep -- --help` gets here: main takes it for a request for help.
      throw InputError(fmt::format("{}: to give a job file of this name, write ./{}",
                                   shortened(line.file), shortened(line.file)));
  }
}

}  // namespace trebsweep
