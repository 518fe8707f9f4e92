#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// The numbers of consecutive tiles: first, ..., end - 1.
struct TileRange {
  std::uint64_t first, end;
};

/// The tiles of a lattice that hold at least one design, numbered along r2, then r3, then r1.
class Tiling {
 public:
  /// `edge` is the extent of a tile; tiles at the upper ends of the axes may be smaller.
  Tiling(const Lattice& lattice, const Index3& edge);

  std::uint64_t size() const;

  Tile tile(std::uint64_t number) const;

  const Index3& edge() const { return edge_; }

 private:
  Index3 extent_, edge_;
  // The number of the first tile of each row of tiles along r2, and the number of all tiles at one
  // r1.
  std::vector<std::uint64_t> first_in_row_;
};

}  // namespace trebsweep
