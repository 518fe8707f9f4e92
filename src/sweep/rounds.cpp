#include "trebsweep/sweep/rounds.hpp"

#include <algorithm>
#include <span>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/schedule.hpp"

namespace trebsweep {
namespace {

/// The results of a round before they are written.
struct Round {
  TileRange tiles;
  std::vector<NumberedTile> own;       ///< tiles of this rank
  std::vector<ComputedTile> computed;  ///< their results
  std::vector<TallyRow> rows;          ///< of all tiles, on rank 0
  std::uint64_t first_scene;
  std::vector<Tally> tallies;        ///< of its scenes, this round included, on rank 0
  std::vector<SceneOptimum> optima;  ///< of the first of these scenes, which are done
  double integration_seconds;        ///< of the slowest rank
  std::size_t most_tiles;            ///< of a rank
};

/// The tallies of the tiles of a round, on rank 0; collective.
std::vector<TallyRow> gather_tallies(const Round& round, MPI_Comm comm) {
  std::vector<TallyRow> rows(round.tiles.end - round.tiles.first, TallyRow{});
  for (std::size_t i = 0; i < round.own.size(); ++i)
    rows[round.own[i].number - round.tiles.first] = to_row(round.computed[i].tally);
  mpi::sum_on_root({rows.data()->data(), rows.size() * tally_columns.size()}, comm);
  return rows;
}

/// The number of a round's scenes that are done with it: all, or all but the last one.
std::uint64_t count_done(const Tiling& tiling, const TileRange& tiles) {
  const std::uint64_t first = tiling.tile(tiles.first).scene,
                      last = tiling.tile(tiles.end - 1).scene;
  return last - first + (tiling.of_scene(last).end <= tiles.end ? 1 : 0);
}

/// Adds the tallies of a round's tiles to those of their scenes. For rank 0.
void add_tallies(const RoundContext& context, const SweepResults& results, Round& round) {
  const std::uint64_t last_scene = context.tiling.tile(round.tiles.end - 1).scene;
  for (std::uint64_t scene = round.first_scene; scene <= last_scene; ++scene)
    round.tallies.push_back(results.tallies[scene]);
  for (std::uint64_t t = round.tiles.first; t < round.tiles.end; ++t)
    round.tallies[context.tiling.tile(t).scene - round.first_scene].add(
        to_tally(round.rows[t - round.tiles.first]));
}

/// Computes tiles on all ranks, and finds the optima of the scenes that are done. `counted` is the
/// time up to which earlier tallies count; that of this round is added to one of its tiles.
/// Collective; returns nothing if any rank was stopped.
std::optional<Round> compute_round(const RoundContext& context, const TileRange& tiles,
                                   const SweepResults& results, double& counted) {
  const MPI_Comm comm = context.comm;
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  const auto assigned = assign_tiles(tiles, ranks, context.study, context.tiling);
  const double start = MPI_Wtime();
  auto computed = compute(assigned[rank], context.study, context.stop);
  if (mpi::max(computed ? 0 : 1, comm) > 0) return std::nullopt;

  Round round{
      .tiles = tiles,
      .own = assigned[rank],
      .computed = std::move(*computed),
      .rows = {},
      .first_scene = context.tiling.tile(tiles.first).scene,
      .tallies = {},
      .optima = {},
      .integration_seconds = mpi::max(MPI_Wtime() - start, comm),
      .most_tiles = std::ranges::max(assigned, {}, &std::vector<NumberedTile>::size).size()};
  for (std::size_t i = 0; i < round.own.size(); ++i)
    if (round.own[i].number == tiles.first) {
      round.computed[i].tally.integration_seconds = round.integration_seconds;
      round.computed[i].tally.sweep_seconds = MPI_Wtime() - counted;
    }
  counted = MPI_Wtime();
  round.rows = gather_tallies(round, comm);
  if (rank == 0) add_tallies(context, results, round);
  if (!is_study(context.study.job())) return round;
  auto optima = scene_optima(context.study, round.first_scene, count_done(context.tiling, tiles),
                             round.tallies, context.refine, context.stop, comm);
  if (!optima) return std::nullopt;
  round.optima = std::move(*optima);
  return round;
}

/// Writes a round's tiles; collective. Ranks with fewer tiles than others take part without one.
/// Returns the checksums of this rank's tiles, one per map.
std::vector<std::vector<std::uint64_t>> write_tiles(const Round& round, ArchiveWriter& archive) {
  std::vector<std::vector<std::uint64_t>> checksums;
  for (std::size_t i = 0; i < round.most_tiles; ++i) {
    if (i < round.computed.size())
      checksums.push_back(archive.write(round.own[i].tile, round.computed[i].maps));
    else
      archive.write(std::nullopt, {});
  }
  return checksums;
}

/// The checksums of a round, on rank 0: for each tile one per map and, of a study, that of the
/// optimum of the scene that ends with it. Collective.
std::vector<std::uint64_t> gather_checksums(const RoundContext& context, const Round& round,
                                            const std::vector<std::vector<std::uint64_t>>& own) {
  const std::size_t maps = stored_fields(context.study.job().output).size();
  const std::size_t columns = maps + (is_study(context.study.job()) ? 1 : 0);
  std::vector<std::uint64_t> rows((round.tiles.end - round.tiles.first) * columns, 0);
  const auto row_of = [&](std::uint64_t tile) {
    return rows.begin() + static_cast<std::ptrdiff_t>((tile - round.tiles.first) * columns);
  };
  for (std::size_t i = 0; i < round.own.size(); ++i)
    std::ranges::copy(own[i], row_of(round.own[i].number));
  mpi::sum_on_root(rows, context.comm);
  for (std::size_t n = 0; n < round.optima.size(); ++n) {
    const std::uint64_t last = context.tiling.of_scene(round.first_scene + n).end - 1;
    row_of(last)[static_cast<std::ptrdiff_t>(maps)] = checksum(round.optima[n]);
  }
  return rows;
}

/// Writes a round and marks its tiles done; collective.
void write_round(const RoundContext& context, const Round& round, ArchiveWriter& archive,
                 SweepResults& results) {
  const bool root = mpi::rank(context.comm) == 0;
  if (root) check_run_id(context.run_id, context.partial);
  const auto checksums = write_tiles(round, archive);
  if (!round.optima.empty()) archive.write_optima(round.first_scene, round.optima);
  archive.checkpoint(round.tiles.first, round.rows, gather_checksums(context, round, checksums));
  if (!root) return;
  const auto first = static_cast<std::ptrdiff_t>(round.first_scene);
  std::ranges::copy(round.tallies, results.tallies.begin() + first);
  std::ranges::copy(round.optima, results.optima.begin() + first);
}

std::uint64_t count_designs(const RoundContext& context, const TileRange& tiles) {
  std::uint64_t designs = 0;
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t) {
    const Tile tile = context.tiling.tile(t);
    designs += context.study.lattice(tile.scene).designs_in(tile.block);
  }
  return designs;
}

}  // namespace

Tally SweepResults::total() const {
  Tally sum;
  for (const Tally& tally : tallies) sum.add(tally);
  return sum;
}

bool run_rounds(const RoundContext& context, std::vector<TileRange> to_compute,
                ArchiveWriter& archive, SweepResults& results) {
  const auto ranks = static_cast<std::uint64_t>(mpi::size(context.comm));
  const std::uint64_t designs = context.study.designs();
  std::uint64_t designs_done = results.total().designs();  // correct on rank 0, which reports it
  Progress progress(designs_done, designs, context.progress);
  const auto& [n1, n3, n2] = context.tiling.edge();
  const std::size_t bytes_per_tile =
      n1 * n3 * n2 * stored_fields(context.study.job().output).size() * sizeof(double);
  const double tile_seconds = context.design_seconds * static_cast<double>(designs) /
                              static_cast<double>(context.tiling.size());
  std::uint64_t tiles_per_rank = first_tiles_per_rank(tile_seconds, bytes_per_tile);
  double counted = context.start_time;
  auto range = to_compute.begin();
  while (range != to_compute.end()) {
    if (range->first == range->end) {
      ++range;
      continue;
    }
    const std::uint64_t most = tiles_per_rank * ranks;
    const TileRange tiles{range->first, std::min(range->first + most, range->end)};
    const double start = MPI_Wtime();
    const auto round = compute_round(context, tiles, results, counted);
    if (!round) break;
    const double seconds = mpi::max(MPI_Wtime() - start, context.comm);
    write_round(context, *round, archive, results);
    designs_done += count_designs(context, tiles);
    progress.update(designs_done);
    if (tiles.end - tiles.first == most)
      tiles_per_rank = next_tiles_per_rank(tiles_per_rank, seconds, bytes_per_tile);
    range->first = tiles.end;
  }
  if (!results.tallies.empty()) results.tallies.front().sweep_seconds += MPI_Wtime() - counted;
  return range == to_compute.end();
}

}  // namespace trebsweep
