#include "trebsweep/job/tiling.hpp"

#include <algorithm>

namespace trebsweep {

Tiling::Tiling(const Lattice& lattice, const Index3& edge)
    : extent_(lattice.extent()), edge_(edge) {
  first_in_row_.push_back(0);
  for (std::size_t i3 = 0; i3 < extent_[1]; i3 += edge_[1]) {
    // Row lengths do not increase with r3, so a tile holds a design if its lowest corner does.
    std::size_t tiles = 0;
    for (std::size_t i2 = 0; i2 < extent_[2] && lattice.holds({0, i3, i2}); i2 += edge_[2]) ++tiles;
    first_in_row_.push_back(first_in_row_.back() + tiles);
  }
}

std::uint64_t Tiling::size() const {
  return (extent_[0] + edge_[0] - 1) / edge_[0] * first_in_row_.back();
}

Tile Tiling::tile(std::uint64_t number) const {
  const std::uint64_t plane = number / first_in_row_.back();
  const std::uint64_t in_plane = number % first_in_row_.back();
  const auto next_row = std::upper_bound(first_in_row_.begin(), first_in_row_.end(), in_plane);
  const auto row = static_cast<std::size_t>(next_row - first_in_row_.begin()) - 1;

  Tile tile{{plane * edge_[0], row * edge_[1], (in_plane - first_in_row_[row]) * edge_[2]}, edge_};
  for (std::size_t d = 0; d < 3; ++d)
    tile.count[d] = std::min(tile.count[d], extent_[d] - tile.first[d]);
  return tile;
}

}  // namespace trebsweep
