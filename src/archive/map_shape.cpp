#include "trebsweep/archive/map_shape.hpp"

namespace trebsweep {
namespace {

/// An index or extent along the outer axes, followed by that along r1, r3 and r2.
std::vector<hsize_t> joined(std::vector<hsize_t> outer, const Index3& inner) {
  outer.insert(outer.end(), inner.begin(), inner.end());
  return outer;
}

}  // namespace

std::vector<hsize_t> unflattened(std::uint64_t position, std::span<const hsize_t> extents) {
  std::vector<hsize_t> index(extents.size());
  for (std::size_t d = index.size(); d-- > 0; position /= extents[d])
    index[d] = position % extents[d];
  return index;
}

MapShape::MapShape(const Study& study) : box_(study.extent()) {
  for (const OuterAxis& axis : study.job().outer_axes) outer_.push_back(axis.values.size());
}

std::vector<hsize_t> MapShape::extent() const { return joined(outer_, box_); }

std::vector<hsize_t> MapShape::block(const Index3& count) const {
  return joined(std::vector<hsize_t>(outer_.size(), 1), count);
}

std::vector<hsize_t> MapShape::first_cell(const Tile& tile) const {
  return joined(unflattened(tile.scene, outer_), tile.block.first);
}

}  // namespace trebsweep
