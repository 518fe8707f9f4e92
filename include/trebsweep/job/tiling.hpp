#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/job/study.hpp"

namespace trebsweep {

/// A block of one scene's lattice that a rank computes and writes at once.
struct Tile {
  std::uint64_t scene;
  Block block;
};

/// The numbers of consecutive tiles: first, ..., end - 1.
struct TileRange {
  std::uint64_t first, end;
};

/// The tiles of a study: those blocks of a regular grid over each scene's box that hold a design.
/// Numbered along r2, then r3, then r1, then the scenes.
class Tiling {
 public:
  /// `edge` is the largest extent of a block; blocks at the upper ends of the axes may be smaller.
  Tiling(const Study& study, const Index3& edge);

  std::uint64_t size() const { return first_of_scene_.back(); }

  Tile tile(std::uint64_t number) const;

  /// The tiles of a scene.
  TileRange of_scene(std::uint64_t scene) const;

  const Index3& edge() const { return edge_; }

 private:
  /// The tiles of one lattice.
  struct Grid {
    std::vector<std::size_t> planes;  // of tiles: their first index along r1
    // The number of the first tile of each row of tiles along r2 in a plane, and the number of all
    // tiles in a plane.
    std::vector<std::uint64_t> first_in_row;

    std::uint64_t size() const { return planes.size() * first_in_row.back(); }
  };

  Grid grid(const Lattice& lattice) const;

  Index3 extent_, edge_;
  std::vector<Grid> grids_;                    // one per Study::lattices()
  std::vector<std::uint32_t> grid_of_;         // of each scene
  std::vector<std::uint64_t> first_of_scene_;  // the number of its first tile; then of all tiles
};

}  // namespace trebsweep
