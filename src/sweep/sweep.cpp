#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/best_designs.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/damaged_tiles.hpp"
#include "trebsweep/sweep/measured_error.hpp"
#include "trebsweep/sweep/rounds.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/sweep/warnings.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

/// What every stage of a sweep uses.
struct Context {
  const Study& study;
  const SweepOptions& options;
  std::string history;  ///< this run's line in the archive's history
  MPI_Comm comm;
};

/// The state of a sweep before its first round.
struct Start {
  bool complete = false;  ///< the archive of this job already exists
  bool resumes = false;   ///< a partial archive of this job exists
  Index3 tile_edge{};
  double design_seconds = 0;     ///< to integrate a design; 0: not measured
  std::uint64_t tiles_done = 0;  ///< by earlier runs
};

/// Only rank 0 reports progress.
ProgressStyle progress_style(const Context& context) {
  return mpi::rank(context.comm) == 0 ? context.options.progress : ProgressStyle::none;
}

/// Refuses to mix ranks with and without fused multiply-add: results would depend on the rank that
/// computed them. Collective.
void check_kernels(MPI_Comm comm) {
  const double fused = has_fma(instruction_set()) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with fused multiply-add (FMA) and some on machines without: "
        "their results differ in the last digits; use nodes of one kind");
}

/// Takes the tiles of an existing partial archive, or chooses those of a new one. For rank 0 only.
Start find_start(const Context& context, const OutputState& output) {
  const Study& study = context.study;
  Start start;
  start.complete = output.complete;
  start.resumes = output.partial.has_value();
  if (start.resumes) {
    start.tile_edge = output.partial->tile_edge;
    start.tiles_done = output.partial->tiles_done;
  } else if (context.options.tile_edge) {
    start.tile_edge = *context.options.tile_edge;
  } else if (!start.complete) {
    start.design_seconds = seconds_per_design(study, context.options.stop);
    start.tile_edge =
        tile_edge(study.extent(), study.scenes(), study.job().output.maps, start.design_seconds);
  }
  for (std::size_t d = 0; d < 3; ++d)
    start.tile_edge[d] = std::min(start.tile_edge[d], study.extent()[d]);
  return start;
}

/// The results of the tiles done by earlier runs, except those that are damaged.
SweepResults earlier_results(const ArchiveContents& partial, const Study& study,
                             const Tiling& tiling, const std::vector<TileRange>& damaged) {
  partial.tally(damaged);  // checks them
  SweepResults results{std::vector<Tally>(study.scenes()), partial.optima};
  for (std::uint64_t t = 0; t < partial.tiles_done; ++t) {
    const auto holds = [&](const TileRange& range) { return range.first <= t && t < range.end; };
    if (std::ranges::none_of(damaged, holds))
      results.tallies[tiling.tile(t).scene].add(to_tally(partial.tallies[t]));
  }
  return results;
}

/// Verifies the tiles done by earlier runs and prepares the partial archive for this run;
/// collective. `to_compute` becomes the damaged tiles and those not done, and `results`, on rank 0,
/// those of the intact ones. Returns the id of this run.
RunId resume(const Context& context, const OutputState& output, const std::filesystem::path& path,
             const Tiling& tiling, std::uint64_t tiles_done, std::vector<TileRange>& to_compute,
             SweepResults& results) {
  const std::filesystem::path partial = partial_path(path);
  const auto maps = map_infos(context.study.job().output);
  require_visible(partial, context.comm);
  Progress progress(0, tiles_done, progress_style(context), "tiles verified");
  const auto damaged = damaged_tiles(partial, maps, context.study, tiling, tiles_done, progress,
                                     context.options.stop, context.comm);
  to_compute = damaged;
  to_compute.push_back({tiles_done, tiling.size()});
  RunId run_id{};
  mpi::on_root(context.comm, [&] {
    if (!damaged.empty())
      print_message(fmt::format(
          "warning: of the {} tiles done, these are damaged and will be computed again: "
          "{}\n",
          tiles_done, to_text(damaged)));
    results = earlier_results(*output.partial, context.study, tiling, damaged);
    run_id = continue_partial(path, context.study, tiling, maps, to_compute, context.history);
  });
  return mpi::from_root(run_id, context.comm);
}

/// Verifies all tiles after damaged ones were computed again: where the index of a map is damaged,
/// they may have been written over others. Returns false if any rank was stopped. Throws
/// mpi::RootError if a tile is damaged. Collective.
bool verify_repairs(const Context& context, const std::filesystem::path& partial,
                    const Tiling& tiling) {
  Progress progress(0, tiling.size(), progress_style(context), "tiles verified");
  const auto damaged =
      damaged_tiles(partial, map_infos(context.study.job().output), context.study, tiling,
                    tiling.size(), progress, context.options.stop, context.comm);
  if (!damaged.empty())
    throw mpi::RootError(
        fmt::format("{}: damaged: of its tiles, these are not as they were written: {}; it cannot "
                    "be continued: remove it, or start again with --overwrite",
                    partial.string(), to_text(damaged)));
  return mpi::max(context.options.stop() ? 1 : 0, context.comm) == 0;
}

/// Creates the partial archive; collective. Returns the id of this run, or nothing if stopped.
std::optional<RunId> create(const Context& context, const std::filesystem::path& path,
                            const Tiling& tiling, const std::string& replaces) {
  const Job& job = context.study.job();
  const auto attributes = root_attributes(job, context.history, replaces);
  const auto maps = map_infos(job.output);
  Progress progress(0, tiling.size(), progress_style(context), "tiles created");
  const auto watch = [&](double share) {
    progress.update(static_cast<std::uint64_t>(share * static_cast<double>(tiling.size())));
    return context.options.stop();
  };
  return create_partial(path, {context.study, tiling, maps, job.output.compression, attributes},
                        watch, context.comm);
}

/// The tally of all scenes, which rank 0 has; collective.
Tally total(const SweepResults& results, MPI_Comm comm) {
  return mpi::from_root(results.total(), comm);
}

/// The optimum between the designs of the lattice: of a study that of the best scene, otherwise
/// found now on rank 0. Collective.
std::optional<RefinedOptimum> refined(const Context& context, const Summary& summary,
                                      const SweepResults& results) {
  const Job& job = context.study.job();
  if (!job.optimum.refine || !summary.optimum) return std::nullopt;
  std::optional<RefinedOptimum> found;
  mpi::on_root(context.comm, [&] {
    found = is_study(job) ? best_refined(job, results.optima)
                          : context.options.refine(job, summary.optimum->design);
  });
  return mpi::from_root(found, context.comm);
}

/// Checks designs of some of the scenes; collective. Returns nothing if any rank was stopped.
std::optional<std::vector<ErrorSample>> check_scenes(const Context& context, const Summary& summary,
                                                     const SweepResults& results) {
  const Study& study = context.study;
  const auto scenes = scenes_to_check(study, summary);
  const double seconds =
      std::max(1.0, 0.01 * summary.sweep_seconds / static_cast<double>(scenes.size()));
  std::vector<ErrorSample> samples;
  for (const std::uint64_t scene : scenes) {
    Tally tally;
    if (mpi::rank(context.comm) == 0) tally = results.tallies[scene];
    const auto optimum = to_summary(mpi::from_root(tally, context.comm), study).optimum;
    auto sample =
        check_scene(study, scene, optimum, summary, seconds, context.options.stop, context.comm);
    if (!sample) return std::nullopt;
    samples.push_back(std::move(*sample));
  }
  return samples;
}

/// Adds to the summary of a complete sweep what is known after its last round. Collective; returns
/// false if any rank was stopped.
bool conclude(const Context& context, const SweepResults& results, Summary& summary) {
  std::vector<ErrorSample> samples;
  if (context.study.job().solver.check) {
    auto checked = check_scenes(context, summary, results);
    if (!checked) return false;
    samples = std::move(*checked);
  }
  summary.error = measured_error(samples, summary.optimum ? summary.optimum->scene : 0);
  summary.refined = refined(context, summary, results);
  summary.optima = results.optima;
  const auto best = best_designs(context.study, summary, context.options.stop, context.comm);
  if (!best) return false;
  summary.warnings = warnings(context.study, summary, *best, samples);
  return true;
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Study study(job);
  check_kernels(comm);
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  const Context context{study, options, history_line(options.command, ranks), comm};

  OutputState output;    // on rank 0 only; holds the archive's lock
  SweepResults results;  // on rank 0 only
  Start start;
  const std::filesystem::path path = mpi::text_of_root(comm, [&] {
    output = open_or_resume(job, options.overwrite);
    start = find_start(context, output);
    results.tallies.resize(study.scenes());
    if (is_study(job)) results.optima.resize(study.scenes());
    return output.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(study, start.tile_edge);
  std::vector<TileRange> to_compute{{0, tiling.size()}};
  std::optional<RunId> run_id;
  if (start.resumes)
    run_id = resume(context, output, path, tiling, start.tiles_done, to_compute, results);
  else
    run_id = create(context, path, tiling, output.replaces);
  if (!run_id) {
    Summary summary;
    summary.complete = false;
    summary.partial_created = false;
    return summary;
  }

  const std::filesystem::path partial = partial_path(path);
  require_visible(partial, comm);
  ArchiveWriter archive(path, map_infos(job.output), study, comm);
  const bool repairs = to_compute.front().first < start.tiles_done;
  const RoundContext rounds{.study = study,
                            .tiling = tiling,
                            .partial = partial,
                            .run_id = *run_id,
                            .design_seconds = start.design_seconds,
                            .start_time = start_time,
                            .progress = progress_style(context),
                            .refine = options.refine,
                            .stop = options.stop,
                            .comm = comm};
  const bool computed = run_rounds(rounds, to_compute, archive, results);

  Summary summary = to_summary(total(results, comm), study);
  // A stop may have left tiles of earlier runs unverified.
  summary.complete = computed && mpi::max(options.stop() ? 1 : 0, comm) == 0 &&
                     conclude(context, results, summary);
  if (summary.complete) archive.write(result_attributes(summary));
  archive.close();
  if (summary.complete && repairs) summary.complete = verify_repairs(context, partial, tiling);
  if (summary.complete) mpi::on_root(comm, [&] { finish_partial(path, *run_id, output.replaces); });
  return summary;
}

}  // namespace trebsweep
