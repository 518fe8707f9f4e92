#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/output_path.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/best_designs.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/measured_error.hpp"
#include "trebsweep/sweep/rank_results.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/sweep/sweep_work.hpp"
#include "trebsweep/sweep/warnings.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// What every stage of a sweep uses.
struct Context {
  const Study& study;
  const SweepOptions& options;
  std::string history;  ///< this run's line in the archive's history
  MPI_Comm comm;
};

/// The state of a sweep before its first tile.
struct Start {
  bool complete = false;  ///< the archive of this job already exists
  bool resumes = false;   ///< an unfinished sweep of this job exists
  std::size_t runs = 0;   ///< of the unfinished sweep
  Index3 tile_edge{};
  double design_seconds = 0;  ///< to integrate a design; 0: not measured
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

/// Takes the tiles of an unfinished sweep, or chooses those of a new one. For rank 0 only.
Start find_start(const Context& context, const OutputState& output) {
  const Study& study = context.study;
  Start start;
  start.complete = output.complete;
  start.resumes = output.partial.has_value();
  if (start.resumes) {
    start.tile_edge = output.partial->tile_edge;
    start.runs = output.partial->history.size();
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

/// Creates the folder of a new sweep, or adds this run to the history of an earlier one. For rank
/// 0.
void open_folder(const Context& context, const OutputState& output, const Start& start,
                 const Tiling& tiling) {
  const Job& job = context.study.job();
  const fs::path folder = partial_path(output.path);
  PartialSweep sweep =
      output.partial.value_or(PartialSweep{.job = to_text(job),
                                           .source = version_text(),
                                           .kernel = std::string(instruction_set()),
                                           .numerics = numerics_version,
                                           .tile_edge = start.tile_edge,
                                           .replaces = output.replaces,
                                           .history = {}});
  sweep.history.push_back(context.history);
  if (!start.resumes) remove_partial(folder);
  write_partial_sweep(folder, sweep);
  if (start.resumes) return;
  try {
    const auto [archive, journals] =
        needed_space(context.study, tiling, map_infos(job.output), job.output.compression);
    require_space(job, unfinished_archive(folder), archive, archive + journals);
  } catch (...) {
    remove_partial(folder);
    throw;
  }
}

/// The optimum between the designs of the lattice: of a study that of the best scene, otherwise
/// found now on rank 0. Collective.
std::optional<RefinedOptimum> refined(const Context& context, const Summary& summary,
                                      const RankResults& results) {
  const Job& job = context.study.job();
  if (!job.optimum.refine || !summary.optimum) return std::nullopt;
  std::optional<RefinedOptimum> found;
  mpi::on_root(context.comm, [&] {
    found = is_study(job) ? best_refined(job, results.optima())
                          : context.options.refine(job, summary.optimum->design);
  });
  return mpi::from_root(found, context.comm);
}

/// Checks designs of some of the scenes; collective. Returns nothing if any rank was stopped.
std::optional<std::vector<ErrorSample>> check_scenes(const Context& context, const Summary& summary,
                                                     const RankResults& results) {
  const Study& study = context.study;
  const auto scenes = scenes_to_check(study, summary);
  const double seconds =
      std::max(1.0, 0.01 * summary.sweep_seconds / static_cast<double>(scenes.size()));
  std::vector<ErrorSample> samples;
  for (const std::uint64_t scene : scenes) {
    auto sample = check_scene(study, scene, optimum_at(results.best()[scene], study), summary,
                              seconds, context.options.stop, context.comm);
    if (!sample) return std::nullopt;
    samples.push_back(std::move(*sample));
  }
  return samples;
}

/// Adds to the summary of a complete sweep what is known once all tiles are done. Collective;
/// returns false if any rank was stopped.
bool conclude(const Context& context, const RankResults& results, Summary& summary) {
  std::vector<ErrorSample> samples;
  if (context.study.job().solver.check) {
    auto checked = check_scenes(context, summary, results);
    if (!checked) return false;
    samples = std::move(*checked);
  }
  summary.error = measured_error(samples, summary.optimum ? summary.optimum->scene : 0);
  summary.refined = refined(context, summary, results);
  summary.optima = results.optima();
  const auto best = best_designs(context.study, summary, context.options.stop, context.comm);
  if (!best) return false;
  summary.warnings = warnings(context.study, summary, *best, samples);
  return true;
}

/// Writes the archive and gives it its final name; collective.
void finish(const Context& context, const OutputState& output, const fs::path& path,
            const Tiling& tiling, RankResults& results, Summary& summary) {
  const Job& job = context.study.job();
  const fs::path folder = partial_path(path), file = unfinished_archive(folder);
  const double start = MPI_Wtime();
  const auto maps = map_infos(job.output);
  std::vector<std::string> history;
  mpi::on_root(context.comm, [&] { history = read_partial_sweep(folder).history; });
  Attributes attributes =
      root_attributes(job, fmt::format("{}", fmt::join(history, "\n")), summary);
  const Skeleton skeleton{context.study,          tiling,     maps,
                          job.output.compression, attributes, summary.optima};
  write_archive(file, skeleton, results.tiles(), context.comm);
  mpi::on_root(context.comm, [&] {
    summary.sweep_seconds += MPI_Wtime() - start;
    hdf5::File archive(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open " + file.string());
    hdf5::write_attribute(archive, "sweep_seconds", summary.sweep_seconds);
    archive.close("write " + file.string());
    rename_to_final(file, path, output.replaces);
    remove_partial(folder);
  });
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Study study(job);
  check_kernels(comm);
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  const Context context{study, options, history_line(options.command, ranks), comm};

  OutputState output;  // on rank 0 only; holds the archive's lock
  Start start;
  const fs::path path = mpi::text_of_root(comm, [&] {
    output = open_or_resume(job, options.overwrite);
    start = find_start(context, output);
    return output.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(study, start.tile_edge);
  const fs::path folder = partial_path(path);
  mpi::on_root(comm, [&] { open_folder(context, output, start, tiling); });
  try {
    require_visible(folder, comm);
  } catch (const mpi::RootError&) {
    if (mpi::rank(comm) == 0 && !start.resumes) remove_partial(folder);
    throw;
  }

  RankResults results(folder, start.runs, start_time, study, tiling, comm);
  const WorkContext work{.study = study,
                         .tiling = tiling,
                         .design_seconds = start.design_seconds,
                         .start_time = start_time,
                         .progress = progress_style(context),
                         .refine = options.refine,
                         .stop = options.stop,
                         .comm = comm};
  bool complete = compute_tiles(work, results);
  results.combine_tallies(comm);
  if (complete) {
    results.combine_best(comm);
    complete = find_scene_optima(work, results);
    results.combine_optima(comm);
  }
  Summary summary = to_summary(results.tally(), study);
  summary.complete = complete && conclude(context, results, summary);
  if (summary.complete)
    finish(context, output, path, tiling, results, summary);
  else
    mpi::on_all(comm, [&] { results.sync(); });
  return summary;
}

}  // namespace trebsweep
