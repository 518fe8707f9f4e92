#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/output_state.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The names of a flag field's values 0, 1, ...
std::vector<std::string> flag_meanings(Field field) {
  if (field == Field::status) return {status_names.begin(), status_names.end()};
  if (field == Field::slack) return {slack_names.begin(), slack_names.end()};
  return {};
}

std::vector<MapInfo> map_infos(const Output& output) {
  const bool has_status = std::count(output.fields.begin(), output.fields.end(), Field::status) > 0;
  std::vector<MapInfo> maps;
  for (const Field field : output.fields) {
    MapInfo map;
    map.dataset = dataset_name(field);
    map.units = std::string(info(field).units);
    map.long_name = std::string(info(field).meaning);
    map.fill = outside_lattice(field);
    map.flag_meanings = flag_meanings(field);
    if (is_flag(field))
      map.type = MapType::uint8;
    else
      map.type = output.storage == Storage::float32 ? MapType::float32 : MapType::float64;
    if (field != Field::status && has_status) map.ancillary = "status";
    maps.push_back(std::move(map));
  }
  return maps;
}

/// Writes a round's tiles; collective.
void write(const std::vector<std::vector<NumberedTile>>& assigned, std::uint64_t rank,
           const std::vector<ComputedTile>& computed, ArchiveWriter& archive) {
  std::size_t most = 0;
  for (const auto& tiles : assigned) most = std::max(most, tiles.size());
  for (std::size_t i = 0; i < most; ++i) {
    if (i < computed.size())
      archive.write(assigned[rank][i].tile, computed[i].maps);
    else
      archive.write(std::nullopt, {});
  }
}

/// The tallies of a round's tiles from `first` on, on rank 0; collective.
std::vector<TallyRow> gather(const std::vector<NumberedTile>& tiles,
                             const std::vector<ComputedTile>& computed, std::uint64_t first,
                             std::uint64_t end, MPI_Comm comm) {
  std::vector<TallyRow> rows(end - first, TallyRow{});
  for (std::size_t i = 0; i < tiles.size(); ++i)
    rows[tiles[i].number - first] = to_row(computed[i].tally);
  mpi::sum_on_root({rows.data()->data(), rows.size() * tally_columns.size()}, comm);
  return rows;
}

/// Refuses ranks whose kernels differ in last digits: a map's would depend on who computed it.
/// Collective.
void check_kernels(MPI_Comm comm) {
  const double fused = has_fma(instruction_set()) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with the fused multiply-add and some on machines without: "
        "their "
        "results differ in last digits; use nodes of one kind");
}

Attributes attributes(const Summary& summary) {
  const Optimum none{{nan, nan, nan}, nan, nan};
  const Optimum optimum = summary.optimum.value_or(none);
  using Count = unsigned long long;
  return {{"best_speed", optimum.speed},
          {"best_r1", optimum.design.r1},
          {"best_r3", optimum.design.r3},
          {"best_r2", optimum.design.r2},
          {"best_release_time", optimum.release_time},
          {"designs", static_cast<Count>(summary.designs())},
          {"steps", static_cast<Count>(summary.steps)},
          {"lane_utilisation", summary.utilisation()},
          {"integration_seconds", summary.integration_seconds},
          {"sweep_seconds", summary.sweep_seconds}};
}

/// What an archive says of itself from the first; the summary's numbers follow in their places.
/// `replaces` is the file_identity() of the archive that it is to replace, if any.
Attributes attributes(const Job& job, const std::string& history, const std::string& replaces) {
  Attributes all = attributes(Summary{});
  all.insert(all.end(), {{"format_version", archive_format},
                         {"Conventions", std::string("CF-1.10")},
                         {"title", "Trebuchet sweep " +
                                       std::filesystem::path(job.output.file).stem().string()},
                         {"source", version_text()},
                         {"kernel", std::string(instruction_set())},
                         {"scene", scene_text(job)},
                         {"job", to_text(job)},
                         {"replaces", replaces},
                         {"history", history}});  // last: when it grows, no other text moves
  return all;
}

/// The extent of the tiles of a new archive.
Index3 choose_edge(const Job& job, const Lattice& lattice, const SweepOptions& options) {
  Index3 edge = options.tile_edge
                    ? *options.tile_edge
                    : tile_edge(lattice.extent(), seconds_per_design(job, lattice, options.stop));
  for (std::size_t d = 0; d < 3; ++d) edge[d] = std::min(edge[d], lattice.extent()[d]);
  return edge;
}

/// Where a sweep stands before its first round.
struct Start {
  bool complete = false;      ///< the archive is there already
  Index3 edge{};              ///< of the tiles
  std::uint64_t done = 0;     ///< tiles that earlier runs have done
  std::optional<RunId> mark;  ///< of the partial file, once it exists
};

/// Finds an archive or a partial file, as rank 0 alone does; `tally` becomes that of what is done.
Start find(const Job& job, const Lattice& lattice, const SweepOptions& options,
           const OutputState& place, const std::string& history, Tally& tally) {
  Start start{.complete = place.complete, .edge = {}, .done = 0, .mark = {}};
  if (!place.partial) {
    if (!start.complete) start.edge = choose_edge(job, lattice, options);
    return start;
  }
  start.edge = place.partial->tile_edge;
  start.done = place.partial->tiles_done;
  tally = place.partial->tally;
  start.mark = continue_partial(place.path, Tiling(lattice, start.edge), map_infos(job.output),
                                start.done, history);
  return start;
}

/// Makes the partial file; collective. Returns the mark of this run, or nothing if stopped.
std::optional<RunId> make(const std::filesystem::path& path, const Job& job, const Lattice& lattice,
                          const Tiling& tiling, const SweepOptions& options,
                          const std::string& history, const std::string& replaces, MPI_Comm comm) {
  const auto all = attributes(job, history, replaces);
  const auto maps = map_infos(job.output);
  Progress progress(0, tiling.size(), mpi::rank(comm) == 0 ? options.progress : ProgressStyle::none,
                    "tiles created");
  const auto watch = [&](double share) {
    progress.update(static_cast<std::uint64_t>(share * static_cast<double>(tiling.size())));
    return options.stop();
  };
  return create_partial(path, {lattice, tiling, maps, job.output.compression, all}, watch, comm);
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Lattice lattice(job.scene, job.lattice);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  // On rank 0 alone: the place with its lock, and the results of earlier runs.
  OutputState place;
  Tally tally;
  Start start;
  check_kernels(comm);
  const std::string history = history_line(options.command, ranks);
  const std::filesystem::path path = mpi::text_of_root(comm, [&] {
    place = open_or_resume(job, options.overwrite);
    start = find(job, lattice, options, place, history, tally);
    return place.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;
  const Tiling tiling(lattice, start.edge);
  if (!start.mark)
    start.mark = make(path, job, lattice, tiling, options, history, place.replaces, comm);
  if (!start.mark) {
    Summary summary;
    summary.complete = false;
    summary.partial_created = false;
    return summary;
  }

  require_visible(partial_path(path), comm);
  ArchiveWriter archive(path, map_infos(job.output), comm);

  std::uint64_t designs_done = tally.designs();  // right on rank 0, which tells it
  Progress progress(designs_done, lattice.designs(),
                    rank == 0 ? options.progress : ProgressStyle::none);
  const std::size_t bytes_per_tile =
      start.edge[0] * start.edge[1] * start.edge[2] * job.output.fields.size() * sizeof(double);
  std::uint64_t next = start.done, batch = 1;
  double counted = start_time;  // the seconds until then are in tallies
  while (next < tiling.size()) {
    const std::uint64_t end = std::min(next + batch * ranks, tiling.size());
    const auto assigned = assign_tiles(next, end, ranks, lattice, tiling);
    const double round_start = MPI_Wtime();
    auto computed = compute(assigned[rank], job, lattice, options.stop);
    const double round_seconds = mpi::max(MPI_Wtime() - round_start, comm);
    const bool all_computed = mpi::max(computed ? 0 : 1, comm) == 0;
    if (!all_computed) break;

    if (rank == 0) check_run_id(*start.mark, partial_path(path));
    write(assigned, rank, *computed, archive);
    for (std::size_t i = 0; i < computed->size(); ++i) {
      ComputedTile& tile = (*computed)[i];
      if (assigned[rank][i].number == next) {
        tile.tally.integration_seconds = round_seconds;
        tile.tally.sweep_seconds = MPI_Wtime() - counted;
      }
      tally.add(tile.tally);
    }
    counted = MPI_Wtime();
    archive.checkpoint(next, gather(assigned[rank], *computed, next, end, comm));
    for (; next < end; ++next) designs_done += lattice.designs_in(tiling.tile(next));
    batch = next_batch(batch, round_seconds, bytes_per_tile);
    progress.update(designs_done);
  }

  if (rank == 0) tally.sweep_seconds += MPI_Wtime() - counted;
  Summary summary = combine(tally, lattice, comm);
  summary.complete = next == tiling.size();
  if (summary.complete) archive.write(attributes(summary));
  archive.close();
  if (summary.complete)
    mpi::on_root(comm, [&] { finish_partial(path, *start.mark, place.replaces); });
  return summary;
}

}  // namespace trebsweep
