#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/damaged_tiles.hpp"
#include "trebsweep/sweep/measured_error.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/sweep/warnings.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

/// What every stage of a sweep uses.
struct Context {
  const Job& job;
  const SweepOptions& options;
  const Lattice& lattice;
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
  Start start;
  start.complete = output.complete;
  start.resumes = output.partial.has_value();
  if (start.resumes) {
    start.tile_edge = output.partial->tile_edge;
    start.tiles_done = output.partial->tiles_done;
  } else if (context.options.tile_edge) {
    start.tile_edge = *context.options.tile_edge;
  } else if (!start.complete) {
    start.design_seconds = seconds_per_design(context.job, context.lattice, context.options.stop);
    start.tile_edge = tile_edge(context.lattice.extent(), start.design_seconds);
  }
  for (std::size_t d = 0; d < 3; ++d)
    start.tile_edge[d] = std::min(start.tile_edge[d], context.lattice.extent()[d]);
  return start;
}

/// Verifies the tiles done by earlier runs and prepares the partial archive for this run;
/// collective. `to_compute` becomes the damaged tiles and those not done, and `tally`, on rank 0,
/// that of the intact ones. Returns the id of this run.
RunId resume(const Context& context, const OutputState& output, const std::filesystem::path& path,
             const Tiling& tiling, std::uint64_t tiles_done, std::vector<TileRange>& to_compute,
             Tally& tally) {
  const std::filesystem::path partial = partial_path(path);
  const auto maps = map_infos(context.job.output);
  require_visible(partial, context.comm);
  Progress progress(0, tiles_done, progress_style(context), "tiles verified");
  const auto damaged = damaged_tiles(partial, maps, tiling, tiles_done, progress,
                                     context.options.stop, context.comm);
  to_compute = damaged;
  to_compute.push_back({tiles_done, tiling.size()});
  RunId run_id{};
  mpi::on_root(context.comm, [&] {
    if (!damaged.empty())
      fmt::print(stderr,
                 "warning: of the {} tiles done, these are damaged and will be computed again: "
                 "{}\n",
                 tiles_done, to_text(damaged));
    tally = output.partial->tally(damaged);
    run_id = continue_partial(path, tiling, maps, to_compute, context.history);
  });
  return mpi::from_root(run_id, context.comm);
}

/// Verifies all tiles after damaged ones were computed again: where the index of a map is damaged,
/// they may have been written over others. Returns false if any rank was stopped. Throws
/// mpi::RootError if a tile is damaged. Collective.
bool verify_repairs(const Context& context, const std::filesystem::path& partial,
                    const Tiling& tiling) {
  Progress progress(0, tiling.size(), progress_style(context), "tiles verified");
  const auto damaged = damaged_tiles(partial, map_infos(context.job.output), tiling, tiling.size(),
                                     progress, context.options.stop, context.comm);
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
  const Output& output = context.job.output;
  const auto attributes = root_attributes(context.job, context.history, replaces);
  const auto maps = map_infos(output);
  Progress progress(0, tiling.size(), progress_style(context), "tiles created");
  const auto watch = [&](double share) {
    progress.update(static_cast<std::uint64_t>(share * static_cast<double>(tiling.size())));
    return context.options.stop();
  };
  return create_partial(path, {context.lattice, tiling, maps, output.compression, attributes},
                        watch, context.comm);
}

/// Writes a round's tiles; collective. Ranks with fewer tiles than others take part without one.
/// Returns the checksums of this rank's tiles, one per map.
std::vector<std::vector<std::uint64_t>> write(
    const std::vector<std::vector<NumberedTile>>& assigned, std::uint64_t rank,
    const std::vector<ComputedTile>& computed, ArchiveWriter& archive) {
  std::size_t writes = 0;
  for (const auto& tiles : assigned) writes = std::max(writes, tiles.size());
  std::vector<std::vector<std::uint64_t>> checksums;
  for (std::size_t i = 0; i < writes; ++i) {
    if (i < computed.size())
      checksums.push_back(archive.write(assigned[rank][i].tile, computed[i].maps));
    else
      archive.write(std::nullopt, {});
  }
  return checksums;
}

/// The tallies of the tiles of a round, on rank 0; collective.
std::vector<TallyRow> gather_tallies(const std::vector<NumberedTile>& tiles,
                                     const std::vector<ComputedTile>& computed,
                                     const TileRange& round, MPI_Comm comm) {
  std::vector<TallyRow> rows(round.end - round.first, TallyRow{});
  for (std::size_t i = 0; i < tiles.size(); ++i)
    rows[tiles[i].number - round.first] = to_row(computed[i].tally);
  mpi::sum_on_root({rows.data()->data(), rows.size() * tally_columns.size()}, comm);
  return rows;
}

/// The checksums of the tiles of a round, one per tile and map, on rank 0; collective.
std::vector<std::uint64_t> gather_checksums(
    const std::vector<NumberedTile>& tiles,
    const std::vector<std::vector<std::uint64_t>>& checksums, const TileRange& round,
    std::size_t maps, MPI_Comm comm) {
  std::vector<std::uint64_t> rows((round.end - round.first) * maps, 0);
  for (std::size_t i = 0; i < tiles.size(); ++i)
    std::copy(checksums[i].begin(), checksums[i].end(),
              rows.begin() + static_cast<std::ptrdiff_t>((tiles[i].number - round.first) * maps));
  mpi::sum_on_root(rows, comm);
  return rows;
}

/// The optimum near that of the lattice, found on rank 0; collective.
std::optional<RefinedOptimum> refined(const Context& context, const Summary& summary) {
  if (!context.job.optimum.refine || !summary.optimum) return std::nullopt;
  std::optional<RefinedOptimum> found;
  mpi::on_root(context.comm,
               [&] { found = context.options.refine(context.job, summary.optimum->design); });
  return mpi::from_root(found, context.comm);
}

/// Computes tiles in rounds. Each round ends with a checkpoint: maps, tallies and checksums are
/// written and flushed, then the tiles are marked done and the marks flushed. A killed run
/// therefore loses at most the round in progress. Collective; ends early if any rank is stopped.
/// `design_seconds` is the time to integrate a design, or 0 if it is unknown; `start_time` is
/// MPI_Wtime() at the start of the sweep. `tally` has the designs of earlier runs on rank 0, and
/// gains those that this rank computes. Returns whether all tiles were computed.
bool run_rounds(const Context& context, const Tiling& tiling, std::vector<TileRange> to_compute,
                double design_seconds, const RunId& run_id, double start_time,
                const std::filesystem::path& partial, ArchiveWriter& archive, Tally& tally) {
  const Job& job = context.job;
  const Lattice& lattice = context.lattice;
  const MPI_Comm comm = context.comm;
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  std::uint64_t designs_done = tally.designs();  // correct on rank 0, which reports it
  Progress progress(designs_done, lattice.designs(), progress_style(context));
  const auto& [n1, n3, n2] = tiling.edge();
  const std::size_t maps = job.output.fields.size();
  const std::size_t bytes_per_tile = n1 * n3 * n2 * maps * sizeof(double);
  const double tile_seconds =
      design_seconds * static_cast<double>(lattice.designs()) / static_cast<double>(tiling.size());
  std::uint64_t tiles_per_rank = first_tiles_per_rank(tile_seconds, bytes_per_tile);
  double counted = start_time;  // tallies include the time up to here
  auto range = to_compute.begin();
  while (range != to_compute.end()) {
    if (range->first == range->end) {
      ++range;
      continue;
    }
    const std::uint64_t most = tiles_per_rank * ranks;
    const TileRange round{range->first, std::min(range->first + most, range->end)};
    const auto assigned = assign_tiles(round, ranks, lattice, tiling);
    const double round_start = MPI_Wtime();
    auto computed = compute(assigned[rank], job, lattice, context.options.stop);
    const double round_seconds = mpi::max(MPI_Wtime() - round_start, comm);
    const bool all_computed = mpi::max(computed ? 0 : 1, comm) == 0;
    if (!all_computed) break;

    if (rank == 0) check_run_id(run_id, partial);
    const auto checksums = write(assigned, rank, *computed, archive);
    for (std::size_t i = 0; i < computed->size(); ++i) {
      Tally& tile_tally = (*computed)[i].tally;
      if (assigned[rank][i].number == round.first) {  // one tile carries the times of the round
        tile_tally.integration_seconds = round_seconds;
        tile_tally.sweep_seconds = MPI_Wtime() - counted;
      }
      tally.add(tile_tally);
    }
    counted = MPI_Wtime();
    archive.checkpoint(round.first, gather_tallies(assigned[rank], *computed, round, comm),
                       gather_checksums(assigned[rank], checksums, round, maps, comm));
    for (std::uint64_t t = round.first; t < round.end; ++t)
      designs_done += lattice.designs_in(tiling.tile(t));
    progress.update(designs_done);
    if (round.end - round.first == most)
      tiles_per_rank = next_tiles_per_rank(tiles_per_rank, round_seconds, bytes_per_tile);
    range->first = round.end;
  }
  if (rank == 0) tally.sweep_seconds += MPI_Wtime() - counted;
  return range == to_compute.end();
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Lattice lattice(job.scene, job.lattice);
  check_kernels(comm);
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  const Context context{job, options, lattice, history_line(options.command, ranks), comm};

  OutputState output;  // on rank 0 only; holds the archive's lock
  Tally tally;         // of this rank's designs, and on rank 0 of those of earlier runs
  Start start;
  const std::filesystem::path path = mpi::text_of_root(comm, [&] {
    output = open_or_resume(job, options.overwrite);
    start = find_start(context, output);
    return output.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(lattice, start.tile_edge);
  std::vector<TileRange> to_compute{{0, tiling.size()}};
  std::optional<RunId> run_id;
  if (start.resumes)
    run_id = resume(context, output, path, tiling, start.tiles_done, to_compute, tally);
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
  ArchiveWriter archive(path, map_infos(job.output), comm);
  const bool complete = run_rounds(context, tiling, to_compute, start.design_seconds, *run_id,
                                   start_time, partial, archive, tally);

  Summary summary = combine(tally, lattice, comm);
  // A stop may have left tiles of earlier runs unverified.
  summary.complete = complete && mpi::max(options.stop() ? 1 : 0, comm) == 0;
  if (summary.complete) {
    std::optional<ErrorSample> sample = ErrorSample{};
    if (job.solver.check) sample = measure_error(job, lattice, summary, options.stop, comm);
    summary.complete = sample.has_value();
    if (sample) {
      summary.error = sample->error;
      summary.refined = refined(context, summary);
      summary.warnings = warnings(job, lattice, summary, sample->checks);
      archive.write(result_attributes(summary));
    }
  }
  archive.close();
  const bool repaired = to_compute.front().first < start.tiles_done;
  if (summary.complete && repaired) summary.complete = verify_repairs(context, partial, tiling);
  if (summary.complete) mpi::on_root(comm, [&] { finish_partial(path, *run_id, output.replaces); });
  return summary;
}

}  // namespace trebsweep
