#include "trebsweep/job/tiling.hpp"

#include <algorithm>

namespace trebsweep {

Tiling::Tiling(const Study& study, const Index3& edge) : extent_(study.extent()) {
  for (std::size_t d = 0; d < 3; ++d) edge_[d] = std::min(edge[d], extent_[d]);
  for (const Lattice& lattice : study.lattices()) grids_.push_back(grid(lattice));
  first_of_scene_.push_back(0);
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
    grid_of_.push_back(study.lattice_of(scene));
    first_of_scene_.push_back(first_of_scene_.back() + grids_[grid_of_.back()].size());
  }
}

Tiling::Grid Tiling::grid(const Lattice& lattice) const {
  Grid grid;
  for (const std::size_t i1 : lattice.r1_indices()) {
    const std::size_t plane = i1 / edge_[0] * edge_[0];
    if (grid.planes.empty() || grid.planes.back() != plane) grid.planes.push_back(plane);
  }
  grid.first_in_row.push_back(0);
  for (std::size_t i3 = 0; i3 < extent_[1]; i3 += edge_[1]) {
    // Row lengths do not increase with r3, so a block holds a design if its first row does.
    const std::size_t length = lattice.row_length(i3);
    grid.first_in_row.push_back(grid.first_in_row.back() + (length + edge_[2] - 1) / edge_[2]);
  }
  return grid;
}

Tile Tiling::tile(std::uint64_t number) const {
  const auto next_scene = std::upper_bound(first_of_scene_.begin(), first_of_scene_.end(), number);
  const auto scene = static_cast<std::uint64_t>(next_scene - first_of_scene_.begin()) - 1;
  const auto& [planes, first_in_row] = grids_[grid_of_[scene]];
  const std::uint64_t in_scene = number - first_of_scene_[scene];
  const std::uint64_t in_plane = in_scene % first_in_row.back();
  const auto next_row = std::upper_bound(first_in_row.begin(), first_in_row.end(), in_plane);
  const auto row = static_cast<std::size_t>(next_row - first_in_row.begin()) - 1;

  Block block{{planes[in_scene / first_in_row.back()], row * edge_[1],
               (in_plane - first_in_row[row]) * edge_[2]},
              edge_};
  for (std::size_t d = 0; d < 3; ++d)
    block.count[d] = std::min(block.count[d], extent_[d] - block.first[d]);
  return {scene, block};
}

TileRange Tiling::of_scene(std::uint64_t scene) const {
  return {first_of_scene_[scene], first_of_scene_[scene + 1]};
}

}  // namespace trebsweep
