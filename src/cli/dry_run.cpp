#include "trebsweep/cli/dry_run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "trebsweep/assess/assessment_cost.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/cli/commands.hpp"
#include "trebsweep/cli/sweep_estimate.hpp"
#include "trebsweep/job/load_job.hpp"
#include "trebsweep/optimum/optimum.hpp"
#include "trebsweep/optimum/search_cost.hpp"

namespace trebsweep {
namespace {

using Json = nlohmann::ordered_json;

std::string ranks_text() {
  const int ranks = mpi::size(MPI_COMM_WORLD);
  return fmt::format("on {} {}, each with a core of its own", ranks, ranks == 1 ? "rank" : "ranks");
}

/// A time as "12.3 s", "4.5 min" or "6.7 h"; two digits are known.
std::string time_text(double seconds) {
  if (seconds < 120) return fmt::format("{:.2g} s", seconds);
  return seconds < 7200 ? fmt::format("{:.2g} min", seconds / 60)
                        : fmt::format("{:.2g} h", seconds / 3600);
}

std::string disk_text(const NeededSpace& space) {
  const auto& [archive, journals] = space;
  if (archive == 0)
    return fmt::format(
        "at least {} until the archive is complete, whose size depends on how well "
        "it compresses",
        size_text(journals));
  return fmt::format("{} until the archive is complete, then {}", size_text(archive + journals),
                     size_text(archive));
}

std::string to_text(const SweepEstimate& cost, const Job& job) {
  std::string text =
      fmt::format("scene     {}\nsolver    {}\n", scene_text(job), solver_text(job.solver));
  text += fmt::format("designs   {} in {} {}", cost.designs, cost.scenes,
                      cost.scenes == 1 ? "scene" : "scenes");
  if (cost.designs_done > 0) text += fmt::format(", {} of them done", cost.designs_done);
  if (cost.complete) text += ", all of them done";
  text += fmt::format("\ntiles     {} of up to {} designs (r1 x r3 x r2)\n", cost.tiles,
                      fmt::join(cost.tile_edge, " x "));
  text += fmt::format("disk      {}\n", disk_text(cost.space));
  text += fmt::format("memory    {} per rank\n",
                      size_text(static_cast<std::uintmax_t>(cost.rank_bytes)));
  const double seconds = cost.design_seconds + cost.scene_seconds;
  text += fmt::format(
      "cores     {:.3g} core-seconds: {:.3g} for the designs, {:.3g} for the optima "
      "of the scenes\n",
      seconds, cost.design_seconds, cost.scene_seconds);
  return text + fmt::format("time      {} {}\narchive   {}\n",
                            time_text(seconds / mpi::size(MPI_COMM_WORLD)), ranks_text(),
                            job.output.file);
}

Json to_json(const SweepEstimate& cost, const Job& job) {
  const auto& [archive, journals] = cost.space;
  const int ranks = mpi::size(MPI_COMM_WORLD);
  const double seconds = cost.design_seconds + cost.scene_seconds;
  return {{"archive", job.output.file},
          {"designs", cost.designs},
          {"designs_done", cost.complete ? cost.designs : cost.designs_done},
          {"scenes", cost.scenes},
          {"tiles", cost.tiles},
          {"archive_bytes", archive == 0 ? Json() : Json(archive)},
          {"journal_bytes", journals},
          {"memory_bytes_per_rank", std::round(cost.rank_bytes)},
          {"design_core_seconds", cost.design_seconds},
          {"scene_core_seconds", cost.scene_seconds},
          {"ranks", ranks},
          {"seconds", seconds / ranks},
          {"refused", cost.refusal.empty() ? Json() : Json(cost.refusal)}};
}

/// Prints names and values, as a JSON object or in lines. For rank 0.
void print_cost(const Json& cost, bool json) {
  if (json) return print_result(cost.dump(2) + "\n");
  std::string text;
  for (auto item = cost.begin(); item != cost.end(); ++item) {
    std::string name = item.key();
    std::ranges::replace(name, '_', ' ');
    text += item->is_number_float() ? fmt::format("{:24}{:.2g}\n", name, item->get<double>())
                                    : fmt::format("{:24}{}\n", name, item->dump());
  }
  print_result(text);
}

void print_search_cost(const Job& job, const CommandLine& line) try {
  const SearchCost cost = search_cost(job, line.overrides.contains("lattice.increment"));
  const std::size_t optima = line.pareto ? line.pareto->points : 1;
  const int ranks = mpi::size(MPI_COMM_WORLD);
  const double seconds = cost.coarse_seconds + cost.search_seconds;
  print_cost({{"optima", optima},
              {"designs", cost.designs},
              {"coarse_core_seconds", cost.coarse_seconds},
              {"search_core_seconds", cost.search_seconds},
              {"ranks", ranks},
              {"seconds", static_cast<double>(optima) * seconds / ranks}},
             line.json);
} catch (const NoOptimum& error) {
  throw InputError(error.what());
}

void dry_optimum(const CommandLine& line) {
  const Job job = load_search(line);
  mpi::on_root(MPI_COMM_WORLD, [&] { print_search_cost(job, line); });
}

void dry_assess(const CommandLine& line) {
  const Job job = load_assessment(line);
  const AssessmentCost cost =
      assessment_cost(job, line.overwrite, job_name(line.file), MPI_COMM_WORLD);
  const int ranks = mpi::size(MPI_COMM_WORLD);
  if (mpi::rank(MPI_COMM_WORLD) == 0)
    print_cost({{"scenes", cost.scenes},
                {"designs", cost.designs},
                {"settings", cost.settings},
                {"reference_core_seconds", cost.reference_seconds},
                {"setting_core_seconds", cost.setting_seconds},
                {"ranks", ranks},
                {"seconds", (cost.reference_seconds + cost.setting_seconds) / ranks}},
               line.json);
}

void dry_sweep(const CommandLine& line) {
  const Study study(load_job(line.file, line.overrides, MPI_COMM_WORLD, line.unset));
  const SweepEstimate cost = estimate(study, line.overwrite, refine, MPI_COMM_WORLD);
  if (mpi::rank(MPI_COMM_WORLD) == 0)
    print_result(line.json ? to_json(cost, study.job()).dump(2) + "\n"
                           : to_text(cost, study.job()));
  if (!cost.refusal.empty()) throw InputError(cost.refusal);
}

}  // namespace

void run_dry(const CommandLine& line) {
  switch (line.command) {
    case Command::optimum:
      return dry_optimum(line);
    case Command::assess:
      return dry_assess(line);
    default:
      return dry_sweep(line);
  }
}

}  // namespace trebsweep
