#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/rank_results.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/sweep/work_queue.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The state of a sweep before its first tile.
struct Start {
  bool complete = false;  ///< the archive of this job already exists
  std::size_t run = 0;    ///< the number of this run of the sweep
  Index3 tile_edge{};
  double design_seconds = 0;  ///< to integrate a design; 0: not measured
};

/// What every stage of a sweep uses.
struct Context {
  const Study& study;
  const Tiling& tiling;
  const SweepOptions& options;
  Start start;
  double start_time;  ///< MPI_Wtime() at the start
  MPI_Comm comm;
};

/// Refuses to mix ranks with and without fused multiply-add: results would depend on the rank that
/// computed them. Collective.
void check_kernels(MPI_Comm comm) {
  const double fused = has_fma(instruction_set()) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with fused multiply-add (FMA) and some on machines without: "
        "their results differ in the last digits; use nodes of one kind");
}

/// Describes a new sweep. For rank 0.
PartialSweep new_sweep(const Study& study, const SweepOptions& options, const OutputFile& output,
                       double& design_seconds) {
  const Job& job = study.job();
  const auto edge = [&] {
    design_seconds = seconds_per_design(study, options.stop);
    return tile_edge(study.extent(), study.scenes(), job.output.maps, design_seconds);
  };
  return {.job = to_text(job),
          .source = version_text(),
          .kernel = std::string(instruction_set()),
          .numerics = numerics_version,
          .tile_edge = options.tile_edge ? *options.tile_edge : edge(),
          .replaces = output.replaces,
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

/// Prepares the folder, clearing that of a new sweep, and describes the sweep in it. For rank 0.
void open_folder(const Context& context, const OutputFile& output, const PartialSweep& sweep) {
  const fs::path folder = partial_path(output.path);
  if (context.start.run == 0) {
    const auto [archive, journals] = needed_space(context.study, context.tiling);
    require_space(context.study.job(), unfinished_archive(folder), archive, archive + journals);
    state_space(context.options, archive, journals);
    clear_partial(folder);
  }
  write_partial_sweep(folder, sweep);
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
  const auto& [study, tiling, options, start, start_time, comm] = context;
  const Output& output = study.job().output;
  const auto& to_do = results.tiles_to_do();
  const auto designs = cumulated_designs(context, to_do);
  const std::uint64_t before = study.designs() - designs.back();
  Progress progress(before, study.designs(),
                    mpi::rank(comm) == 0 ? options.progress : ProgressStyle::none);
  const double ranks = mpi::size(comm);
  double counted = start_time;  // the time up to which tallies count
  const auto work = [&, &study = study, &tiling = tiling](
                        const TileRange& range,
                        const std::function<bool()>& poll) -> std::uint64_t {
    std::vector<Tile> tiles;
    for (std::uint64_t n = range.first; n < range.end; ++n) tiles.push_back(tiling.tile(to_do[n]));
    const double begin = MPI_Wtime();
    auto computed = compute(tiles, study, poll);
    const double end = MPI_Wtime();
    const std::uint64_t done = range.first + computed.size();
    const auto all = static_cast<double>(designs[done] - designs[range.first]);
    for (std::size_t i = 0; i < computed.size(); ++i) {
      auto& [values, tally] = computed[i];
      const double share = static_cast<double>(tally.designs()) / all / ranks;
      tally.integration_seconds = share * (end - begin);
      tally.sweep_seconds = share * (end - counted);
      results.add(RecordKind::tile, to_do[range.first + i],
                  to_bytes(tally, std::move(values), output));
    }
    counted = end;
    progress.update(before + designs[done]);
    return computed.size();
  };
  const double tile_seconds = start.design_seconds * static_cast<double>(study.designs()) /
                              static_cast<double>(tiling.size());
  // As many as share_out() wants; a resumed sweep has not measured the time.
  const double first = tile_seconds > 0 ? std::clamp(0.25 / tile_seconds, 1.0, 1e9) : 1;
  const std::uint64_t most = std::max<std::uint64_t>(
      1, (std::uint64_t{64} << 20) / result_bytes({{}, tiling.edge()}, output));
  const bool all =
      share_out(to_do.size(), static_cast<std::uint64_t>(first), most, work, options.stop, comm);
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
  const auto work = [&](const TileRange& range, const std::function<bool()>& poll) {
    std::uint64_t n = range.first;
    do {
      const std::uint64_t scene = to_do[n++];
      const BestDesign optimum =
          scene_optimum(job_at(job, scene), best[scene], context.options.refine);
      results.add(RecordKind::scene, scene, to_bytes(optimum));
    } while (n < range.end && !poll());
    return n - range.first;
  };
  constexpr std::uint64_t most = 100'000;
  const bool all = share_out(to_do.size(), 1, most, work, context.options.stop, context.comm);
  results.combine_optima(context.comm);
  return all;
}

/// Writes the archive and gives it its final name; collective.
void write_output(const Context& context, const OutputFile& output,
                  const std::vector<std::string>& history, const fs::path& folder,
                  RankResults& results, Summary& summary) {
  const auto& [study, tiling, options, started, start_time, comm] = context;
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

std::optional<SweepResult> sweep(const Study& study, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  Start start;
  check_kernels(comm);
  // On rank 0 only; the first holds the lock.
  OutputFile output;
  PartialSweep description;
  const fs::path folder = mpi::text_of_root(comm, [&] {
    output = open_or_resume(study.job(), options.overwrite);
    start.complete = output.complete;
    if (!start.complete) {
      description = output.partial ? *output.partial
                                   : new_sweep(study, options, output, start.design_seconds);
      start.tile_edge = description.tile_edge;
      start.run = description.history.size();
      description.history.push_back(history_line(options.command, mpi::size(comm)));
    }
    return partial_path(output.path).string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(study, start.tile_edge);
  const Context context{study, tiling, options, start, start_time, comm};
  mpi::on_root(comm, [&] { open_folder(context, output, description); });
  try {
    require_visible(folder, comm);
  } catch (const mpi::RootError&) {
    if (mpi::rank(comm) == 0 && start.run == 0) clear_partial(folder);
    throw;
  }

  RankResults results(folder, start.run, start_time, study, tiling, comm);
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
