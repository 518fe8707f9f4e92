#include "trebsweep/sweep/schedule.hpp"

#include <algorithm>

namespace trebsweep {
namespace {

std::uint64_t cells(const Index3& edge) { return Block{{}, edge}.cells(); }

std::uint64_t tiles_along(const Index3& extent, const Index3& edge, std::size_t axis) {
  return (extent[axis] + edge[axis] - 1) / edge[axis];
}

/// The largest divisor of the extent between two thirds of an edge and the edge; otherwise the
/// edge. Where the end of an axis cuts a chunk, HDF5 writes it in many small pieces.
std::size_t even_edge(std::size_t edge, std::size_t extent) {
  for (std::size_t e = edge; 3 * e >= 2 * edge; --e)
    if (extent % e == 0) return e;
  return edge;
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
    if (d > 0) edge[d] = even_edge(edge[d], extent[d]);  // along r1 the pieces are large
  }
  // On a flat or linear lattice, or for many scenes, these edges give tiles of few cells.
  constexpr std::array<std::size_t, 3> axes{0, 1, 2};
  const auto along = [&](std::size_t axis) { return tiles_along(extent, edge, axis); };
  const auto tiles = [&] { return along(0) * along(1) * along(2); };
  while (scenes * tiles() > many_tiles && tiles() > 1 && 2 * cells(edge) <= max_cells) {
    const std::size_t axis = std::ranges::max(axes, {}, along);
    edge[axis] = std::min(2 * edge[axis], extent[axis]);
  }
  constexpr std::uint64_t most_tiles = 1'000'000;
  while (static_cast<double>(cells(edge)) * design_seconds > max_seconds && cells(edge) > 1 &&
         scenes * tiles() < most_tiles) {
    auto& longest_edge = *std::ranges::max_element(edge);
    longest_edge = (longest_edge + 1) / 2;
  }
  return edge;
}

std::uint64_t next_count(std::uint64_t count, double seconds, double target) {
  const double factor = std::clamp(target / std::max(seconds, 1e-9), 0.1, 8.0);
  return static_cast<std::uint64_t>(std::max(1.0, static_cast<double>(count) * factor));
}

}  // namespace trebsweep
