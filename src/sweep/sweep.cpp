#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/rank_results.hpp"
#include "trebsweep/sweep/work_queue.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// What every stage of a sweep uses.
struct Context {
  const Study& study;
  const Tiling& tiling;
  const SweepOptions& options;
  double start_time;  ///< MPI_Wtime() at the start
  MPI_Comm comm;
};

/// Describes a new sweep. For rank 0.
PartialSweep new_sweep(const Study& study, const SweepOptions& options, std::string replaces) {
  const Job& job = study.job();
  return {.job = to_text(job),
          .source = version_text(),
          .kernel = std::string(instruction_set()),
          .numerics = numerics_version,
          .tile_edge = options.tile_edge ? *options.tile_edge : tile_edge(study),
          .replaces = std::move(replaces),
          .history = {}};
}

/// Tells how much disk space a large sweep needs; `archive` is 0 if it is unknown.
void state_space(const SweepOptions& options, std::uintmax_t archive, std::uintmax_t journals) {
  constexpr std::uintmax_t large = 100'000'000;
  if (options.progress == ProgressStyle::none || archive + journals < large) return;
  const std::string least = archive == 0 ? "at least " : "";
  print_message(fmt::format("disk space: {}{} until the archive is complete{}\n", least,
                            size_text(archive + journals),
                            archive == 0 ? "" : ", then " + size_text(archive)));
}

/// Describes a run in the folder of its sweep, which it clears for a new one. For rank 0.
PartialSweep open_folder(const Study& study, const SweepOptions& options, const OutputFile& output,
                         int ranks) {
  const fs::path folder = partial_path(output.path);
  PartialSweep sweep =
      output.partial ? *output.partial : new_sweep(study, options, output.replaces);
  if (!output.partial) {
    const auto [archive, journals] = needed_space(study, Tiling(study, sweep.tile_edge));
    require_space(study.job(), unfinished_archive(folder), archive, archive + journals);
    state_space(options, archive, journals);
    clear_partial(folder);
  }
  sweep.history.push_back(history_line(options.command, ranks));
  write_partial_sweep(folder, sweep);
  return sweep;
}

/// Throws mpi::RootError if a rank cannot see the folder of a sweep, as when ranks run in different
/// directories or on file systems that they do not share. Collective.
void require_visible(const fs::path& folder, MPI_Comm comm) {
  mpi::on_all(comm, [&] {
    if (!fs::exists(folder))
      throw std::runtime_error(fmt::format(
          "rank {} cannot see {}: all ranks must run in the same directory of a shared file system",
          mpi::rank(comm), folder.string()));
  });
}

/// The numbers of designs in the first n tiles of a list, n = 0, 1, ...
std::vector<std::uint64_t> cumulated_designs(const Context& context,
                                             const std::vector<std::uint64_t>& tiles) {
  std::vector<std::uint64_t> designs{0};
  for (const std::uint64_t number : tiles) {
    const Tile tile = context.tiling.tile(number);
    designs.push_back(designs.back() + context.study.lattice(tile.scene).designs_in(tile.block));
  }
  return designs;
}

/// Computes the tiles that are to be done, which the ranks share out. Collective; returns whether
/// all are done. Throws mpi::RootError if a journal cannot be written.
bool compute_tiles(const Context& context, RankResults& results) {
  const auto& [study, tiling, options, start_time, comm] = context;
  const Output& output = study.job().output;
  const auto& to_do = results.tiles_to_do();
  const auto designs = cumulated_designs(context, to_do);
  const std::uint64_t before = study.designs() - designs.back();
  Progress progress(before, study.designs(),
                    mpi::rank(comm) == 0 ? options.progress : ProgressStyle::none);
  const double ranks = mpi::size(comm);
  double counted = start_time;  // the time up to which tallies count
  Compute compute(study);
  const auto work = [&](std::uint64_t n, const std::function<void()>& poll) {
    const double begin = MPI_Wtime();
    auto [maps, tally] = compute.tile(context.tiling.tile(to_do[n]), poll);
    const double end = MPI_Wtime();
    tally.integration_seconds = (end - begin) / ranks;
    tally.sweep_seconds = (end - counted) / ranks;
    counted = end;
    results.add(to_do[n], to_bytes(tally, std::move(maps), output));
    progress.update(before + designs[n + 1]);
  };
  const bool all = share_out(to_do.size(), work, options.stop, comm);
  results.totals().tally.sweep_seconds += (MPI_Wtime() - counted) / ranks;
  results.combine_tiles(comm);
  return all;
}

/// Finds the optima of the scenes that are to be done, from the best designs of their lattices.
/// Collective; returns whether all are done. Throws as compute_tiles() does, and if the refinement
/// throws.
bool find_optima(const Context& context, RankResults& results) {
  const Job& job = context.study.job();
  const auto& best = results.totals().best;
  auto to_do = results.scenes_to_do();
  std::erase_if(to_do, [&](std::uint64_t scene) { return !best[scene].exists(); });
  const auto work = [&](std::uint64_t n, const std::function<void()>&) {
    const std::uint64_t scene = to_do[n];
    results.add(context.tiling.size() + scene,
                to_bytes(scene_optimum(job_at(job, scene), best[scene], context.options.refine)));
  };
  const bool all = share_out(to_do.size(), work, context.options.stop, context.comm);
  results.combine_optima(context.comm);
  return all;
}

/// Writes the archive and gives it its final name; collective.
void write_output(const Context& context, const OutputFile& output,
                  const std::vector<std::string>& history, const fs::path& folder,
                  RankResults& results, Summary& summary) {
  const auto& [study, tiling, options, start_time, comm] = context;
  const fs::path file = unfinished_archive(folder);
  const double start = MPI_Wtime();
  const auto own = results.tiles();
  std::uint64_t found = own.size();
  mpi::sum({&found, 1}, comm);
  if (found != tiling.size())
    throw mpi::RootError(
        fmt::format("a journal in {} is damaged; the same command computes again what it held",
                    folder.string()));
  write_archive(file, {study, tiling, summary.optima}, own, comm);
  summary.tally.sweep_seconds += MPI_Wtime() - start;
  mpi::on_root(comm, [&, &job = study.job()] { write_attributes(file, job, history, summary); });
  mpi::on_all(comm, [&] { sync_file(file); });  // on every host
  mpi::on_root(comm, [&] { finish_output(output); });
}

}  // namespace

void check_arithmetic(std::string_view instruction_set, MPI_Comm comm) {
  const double fused = has_fma(instruction_set) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with fused multiply-add (FMA) and some on machines without: "
        "their results differ in the last digits; use nodes of one kind");
}

std::optional<SweepResult> sweep(const Study& study, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  check_arithmetic(instruction_set(), comm);
  // On rank 0 only; the first holds the lock.
  OutputFile output;
  PartialSweep description;
  const fs::path folder = mpi::text_of_root(comm, [&] {
    output = open_or_resume(study.job(), options.overwrite);
    if (output.complete) return std::string();
    description = open_folder(study, options, output, mpi::size(comm));
    return partial_path(output.path).string();
  });
  if (folder.empty()) return std::nullopt;
  try {
    require_visible(folder, comm);
  } catch (const mpi::RootError&) {
    if (mpi::rank(comm) == 0 && !output.partial) clear_partial(folder);
    throw;
  }

  const Tiling tiling(study, mpi::from_root(description.tile_edge, comm));
  const std::size_t run = mpi::from_root(description.history.size(), comm);
  const Context context{study, tiling, options, start_time, comm};
  RankResults results(folder, run - 1, start_time, study, tiling, comm);
  bool complete = compute_tiles(context, results) && find_optima(context, results);
  SweepResult result{.summary = results.totals().summary(), .samples = {}};
  if (complete && study.job().solver.check) {
    auto samples = check_scenes(study, results.totals(), options.stop, comm);
    complete = samples.has_value();
    if (samples) result.samples = std::move(*samples);
  }
  result.summary.complete = complete;
  if (complete) {
    result.summary.error = measured_error(result.samples, result.summary.best().value_or(0));
    write_output(context, output, description.history, folder, results, result.summary);
  } else {
    mpi::on_all(comm, [&] { results.sync(); });
  }
  return result;
}

}  // namespace trebsweep
