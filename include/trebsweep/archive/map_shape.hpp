#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <vector>

#include "trebsweep/job/study.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// The index of a cell in an array of the given extents, from its position in the flattened array,
/// last axis fastest.
std::vector<hsize_t> unflattened(std::uint64_t position, std::span<const hsize_t> extents);

/// The axes of a study's maps: the outer axes, then r1, r3 and r2.
class MapShape {
 public:
  explicit MapShape(const Study& study);

  /// The number of axes.
  int rank() const { return static_cast<int>(outer_.size() + 3); }

  /// The extents of the outer axes.
  const std::vector<hsize_t>& outer() const { return outer_; }

  /// The extent of a map.
  std::vector<hsize_t> extent() const;

  /// The extent in a map of a block of one scene.
  std::vector<hsize_t> block(const Index3& count) const;

  /// The index in a map of a tile's first cell.
  std::vector<hsize_t> first_cell(const Tile& tile) const;

 private:
  std::vector<hsize_t> outer_;
  Index3 box_;
};

}  // namespace trebsweep
