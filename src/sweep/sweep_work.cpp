#include "trebsweep/sweep/sweep_work.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/work_queue.hpp"

namespace trebsweep {
namespace {

/// The numbers of designs in the first n tiles of a list, n = 0, 1, ...
std::vector<std::uint64_t> cumulated_designs(const WorkContext& context,
                                             const std::vector<std::uint64_t>& tiles) {
  std::vector<std::uint64_t> designs{0};
  for (const std::uint64_t number : tiles) {
    const Tile tile = context.tiling.tile(number);
    designs.push_back(designs.back() + context.study.lattice(tile.scene).designs_in(tile.block));
  }
  return designs;
}

}  // namespace

bool compute_tiles(const WorkContext& context, RankResults& results) {
  const auto& [study, tiling, design_seconds, start_time, style, refine, stop, comm] = context;
  const auto maps = map_infos(study.job().output);
  const auto& to_do = results.tiles_to_do();
  const auto designs = cumulated_designs(context, to_do);
  const std::uint64_t before = study.designs() - designs.back();
  Progress progress(before, study.designs(), style);
  const double ranks = mpi::size(comm);
  double counted = start_time;  // the time up to which tallies count
  const auto work = [&, &study = study, &tiling = tiling](
                        const TileRange& range,
                        const std::function<bool()>& poll) -> std::uint64_t {
    std::vector<NumberedTile> tiles;
    for (std::uint64_t n = range.first; n < range.end; ++n)
      tiles.push_back({to_do[n], tiling.tile(to_do[n])});
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
      results.add({RecordKind::tile, tiles[i].number, to_bytes(tally, values, maps)});
    }
    counted = end;
    progress.update(before + designs[done]);
    return computed.size();
  };
  const double tile_seconds =
      design_seconds * static_cast<double>(study.designs()) / static_cast<double>(tiling.size());
  // As many as share_out() wants; a resumed sweep has not measured the time.
  const double first = tile_seconds > 0 ? std::clamp(0.25 / tile_seconds, 1.0, 1e9) : 1;
  const std::uint64_t tile_bytes = bytes_in({0, {{}, tiling.edge()}}, maps) + sizeof(Tally);
  const std::uint64_t most = std::max<std::uint64_t>(1, (std::uint64_t{64} << 20) / tile_bytes);
  const bool all =
      share_out(to_do.size(), static_cast<std::uint64_t>(first), most, work, stop, comm);
  results.tally().sweep_seconds += (MPI_Wtime() - counted) / ranks;
  return all;
}

bool find_scene_optima(const WorkContext& context, RankResults& results) {
  const Study& study = context.study;
  auto to_do = results.scenes_to_do();
  std::erase_if(to_do, [&](std::uint64_t scene) { return !results.best()[scene].exists(); });
  const auto work = [&](const TileRange& range, const std::function<bool()>& poll) {
    std::uint64_t n = range.first;
    do {
      const std::uint64_t scene = to_do[n++];
      const SceneOptimum optimum = scene_optimum(
          job_at(study.job(), scene), *optimum_at(results.best()[scene], study), context.refine);
      results.add({RecordKind::scene, scene, std::as_bytes(std::span(&optimum, 1))});
    } while (n < range.end && !poll());
    return n - range.first;
  };
  constexpr std::uint64_t most = 100'000;
  return share_out(to_do.size(), 1, most, work, context.stop, context.comm);
}

}  // namespace trebsweep
