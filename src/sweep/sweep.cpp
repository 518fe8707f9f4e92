#include "trebsweep/sweep/sweep.hpp"

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/compute.hpp"
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
  Index3 tile_edge{};
  std::uint64_t tiles_done = 0;  ///< by earlier runs
  std::optional<RunId> run_id;   ///< this run's, once the partial archive exists
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

/// The extent of the tiles of a new archive.
Index3 choose_tile_edge(const Context& context) {
  const Index3 extent = context.lattice.extent();
  Index3 edge = context.options.tile_edge
                    ? *context.options.tile_edge
                    : tile_edge(extent, seconds_per_design(context.job, context.lattice,
                                                           context.options.stop));
  for (std::size_t d = 0; d < 3; ++d) edge[d] = std::min(edge[d], extent[d]);
  return edge;
}

/// Prepares an existing partial archive for this run, or chooses the tiles of a new one. For rank 0
/// only. `tally` becomes that of the tiles done.
Start find_start(const Context& context, const OutputState& output, Tally& tally) {
  Start start;
  start.complete = output.complete;
  if (!output.partial) {
    if (!start.complete) start.tile_edge = choose_tile_edge(context);
    return start;
  }
  start.tile_edge = output.partial->tile_edge;
  start.tiles_done = output.partial->tiles_done;
  tally = output.partial->tally;
  start.run_id = continue_partial(output.path, Tiling(context.lattice, start.tile_edge),
                                  map_infos(context.job.output), start.tiles_done, context.history);
  return start;
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
void write(const std::vector<std::vector<NumberedTile>>& assigned, std::uint64_t rank,
           const std::vector<ComputedTile>& computed, ArchiveWriter& archive) {
  std::size_t writes = 0;
  for (const auto& tiles : assigned) writes = std::max(writes, tiles.size());
  for (std::size_t i = 0; i < writes; ++i) {
    if (i < computed.size())
      archive.write(assigned[rank][i].tile, computed[i].maps);
    else
      archive.write(std::nullopt, {});
  }
}

/// The tallies of the tiles [first, end) of a round, on rank 0; collective.
std::vector<TallyRow> gather(const std::vector<NumberedTile>& tiles,
                             const std::vector<ComputedTile>& computed, std::uint64_t first,
                             std::uint64_t end, MPI_Comm comm) {
  std::vector<TallyRow> rows(end - first, TallyRow{});
  for (std::size_t i = 0; i < tiles.size(); ++i)
    rows[tiles[i].number - first] = to_row(computed[i].tally);
  mpi::sum_on_root({rows.data()->data(), rows.size() * tally_columns.size()}, comm);
  return rows;
}

/// Computes the remaining tiles in rounds. Each round ends with a checkpoint: maps and tallies are
/// written and flushed, then the tiles are marked done and the marks flushed. A killed run
/// therefore loses at most the round in progress. Collective; ends early if any rank is stopped.
/// `start_time` is MPI_Wtime() at the start of the sweep. `tally` has the designs of earlier runs
/// on rank 0, and gains those that this rank computes. Returns the number of tiles done.
std::uint64_t run_rounds(const Context& context, const Tiling& tiling, const Start& start,
                         double start_time, const std::filesystem::path& partial,
                         ArchiveWriter& archive, Tally& tally) {
  const Job& job = context.job;
  const Lattice& lattice = context.lattice;
  const MPI_Comm comm = context.comm;
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  std::uint64_t designs_done = tally.designs();  // correct on rank 0, which reports it
  Progress progress(designs_done, lattice.designs(), progress_style(context));
  const auto& [n1, n3, n2] = tiling.edge();
  const std::size_t bytes_per_tile = n1 * n3 * n2 * job.output.fields.size() * sizeof(double);
  std::uint64_t next = start.tiles_done, tiles_per_rank = 1;
  double counted = start_time;  // tallies include the time up to here
  while (next < tiling.size()) {
    const std::uint64_t end = std::min(next + tiles_per_rank * ranks, tiling.size());
    const auto assigned = assign_tiles(next, end, ranks, lattice, tiling);
    const double round_start = MPI_Wtime();
    auto computed = compute(assigned[rank], job, lattice, context.options.stop);
    const double round_seconds = mpi::max(MPI_Wtime() - round_start, comm);
    const bool all_computed = mpi::max(computed ? 0 : 1, comm) == 0;
    if (!all_computed) break;

    if (rank == 0) check_run_id(*start.run_id, partial);
    write(assigned, rank, *computed, archive);
    for (std::size_t i = 0; i < computed->size(); ++i) {
      Tally& tile_tally = (*computed)[i].tally;
      if (assigned[rank][i].number == next) {  // one tile carries the times of the round
        tile_tally.integration_seconds = round_seconds;
        tile_tally.sweep_seconds = MPI_Wtime() - counted;
      }
      tally.add(tile_tally);
    }
    counted = MPI_Wtime();
    archive.checkpoint(next, gather(assigned[rank], *computed, next, end, comm));
    for (; next < end; ++next) designs_done += lattice.designs_in(tiling.tile(next));
    tiles_per_rank = next_tiles_per_rank(tiles_per_rank, round_seconds, bytes_per_tile);
    progress.update(designs_done);
  }
  if (rank == 0) tally.sweep_seconds += MPI_Wtime() - counted;
  return next;
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
    start = find_start(context, output, tally);
    return output.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(lattice, start.tile_edge);
  if (!start.run_id) start.run_id = create(context, path, tiling, output.replaces);
  if (!start.run_id) {
    Summary summary;
    summary.complete = false;
    summary.partial_created = false;
    return summary;
  }

  const std::filesystem::path partial = partial_path(path);
  require_visible(partial, comm);
  ArchiveWriter archive(path, map_infos(job.output), comm);
  const std::uint64_t tiles_done =
      run_rounds(context, tiling, start, start_time, partial, archive, tally);

  Summary summary = combine(tally, lattice, comm);
  summary.complete = tiles_done == tiling.size();
  if (summary.complete) {
    std::optional<ErrorSample> sample = ErrorSample{};
    if (job.solver.check) sample = measure_error(job, lattice, summary, options.stop, comm);
    summary.complete = sample.has_value();
    if (sample) {
      summary.error = sample->error;
      summary.warnings = warnings(job, lattice, summary, sample->checks);
      archive.write(result_attributes(summary));
    }
  }
  archive.close();
  if (summary.complete)
    mpi::on_root(comm, [&] { finish_partial(path, *start.run_id, output.replaces); });
  return summary;
}

}  // namespace trebsweep
