#include "trebsweep/sweep/schedule.hpp"

#include <algorithm>
#include <queue>

namespace trebsweep {
namespace {

std::uint64_t cells(const Index3& edge) { return std::uint64_t{edge[0]} * edge[1] * edge[2]; }

std::uint64_t tiles_along(const Index3& extent, const Index3& edge, std::size_t axis) {
  return (extent[axis] + edge[axis] - 1) / edge[axis];
}

std::uint64_t max_tiles_per_rank(std::size_t bytes_per_tile) {
  constexpr std::uint64_t max_bytes = 64 << 20;
  return std::max<std::uint64_t>(1, max_bytes / std::max<std::size_t>(1, bytes_per_tile));
}

}  // namespace

Index3 tile_edge(const Index3& extent, std::uint64_t scenes, Maps maps, double design_seconds) {
  // Without maps only the tallies of tiles are written, which are then most of the archive.
  const bool has_maps = maps == Maps::all;
  const std::uint64_t many_tiles = has_maps ? 4096 : 512;
  const std::uint64_t max_cells = has_maps ? 48 * 48 * 48 : 2 * cells(extent);
  constexpr double max_seconds = 1;
  Index3 edge;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t longest = extent[d] > 2500 ? 64 : 48;
    edge[d] = std::min(extent[d], std::clamp<std::size_t>((extent[d] + 4) / 5, 16, longest));
  }
  // On a flat or linear lattice, or for many scenes, these edges give tiles of few cells.
  constexpr std::array<std::size_t, 3> axes{0, 1, 2};
  const auto along = [&](std::size_t axis) { return tiles_along(extent, edge, axis); };
  const auto tiles = [&] { return along(0) * along(1) * along(2); };
  while (scenes * tiles() > many_tiles && tiles() > 1 && 2 * cells(edge) <= max_cells) {
    const std::size_t axis =
        *std::max_element(axes.begin(), axes.end(),
                          [&](std::size_t a, std::size_t b) { return along(a) < along(b); });
    edge[axis] = std::min(2 * edge[axis], extent[axis]);
  }
  constexpr std::uint64_t most_tiles = 1'000'000;
  while (static_cast<double>(cells(edge)) * design_seconds > max_seconds && cells(edge) > 1 &&
         scenes * tiles() < most_tiles) {
    auto& longest_edge = *std::max_element(edge.begin(), edge.end());
    longest_edge = (longest_edge + 1) / 2;
  }
  return edge;
}

std::vector<std::vector<NumberedTile>> assign_tiles(const TileRange& range, std::uint64_t ranks,
                                                    const Study& study, const Tiling& tiling) {
  struct SizedTile {
    std::uint64_t designs, number;
  };
  std::vector<SizedTile> tiles;
  for (std::uint64_t t = range.first; t < range.end; ++t) {
    const Tile tile = tiling.tile(t);
    tiles.push_back({study.lattice(tile.scene).designs_in(tile.block), t});
  }
  std::stable_sort(tiles.begin(), tiles.end(),
                   [](const SizedTile& a, const SizedTile& b) { return a.designs > b.designs; });

  using Load = std::pair<std::uint64_t, std::uint64_t>;  // designs, rank
  std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
  for (std::uint64_t rank = 0; rank < ranks; ++rank) loads.push({0, rank});
  std::vector<std::vector<NumberedTile>> assigned(ranks);
  for (const auto& [designs, number] : tiles) {
    const auto [load, rank] = loads.top();
    loads.pop();
    assigned[rank].push_back({number, tiling.tile(number)});
    loads.push({load + designs, rank});
  }
  return assigned;
}

std::uint64_t next_count(std::uint64_t count, double seconds, double target) {
  const double factor = std::clamp(target / std::max(seconds, 1e-9), 0.1, 8.0);
  return std::max<std::uint64_t>(1,
                                 static_cast<std::uint64_t>(static_cast<double>(count) * factor));
}

std::uint64_t first_tiles_per_rank(double tile_seconds, std::size_t bytes_per_tile) {
  if (tile_seconds <= 0) return 1;
  const double tiles = std::clamp(0.25 / tile_seconds, 1.0, 1e9);
  return std::min(static_cast<std::uint64_t>(tiles), max_tiles_per_rank(bytes_per_tile));
}

std::uint64_t next_tiles_per_rank(std::uint64_t tiles_per_rank, double round_seconds,
                                  std::size_t bytes_per_tile) {
  return std::min(next_count(tiles_per_rank, round_seconds, 2.0),
                  max_tiles_per_rank(bytes_per_tile));
}

}  // namespace trebsweep
