#include "trebsweep/archive/map_shape.hpp"

#include "support/catch.hpp"

using namespace trebsweep;

using Extent = std::vector<hsize_t>;

TEST_CASE("The last axis of a flattened array is the fastest") {
  CHECK(unflattened(0, Extent{2, 3, 4}) == Extent{0, 0, 0});
  CHECK(unflattened(17, Extent{2, 3, 4}) == Extent{1, 1, 1});
  CHECK(unflattened(23, Extent{2, 3, 4}) == Extent{1, 2, 3});
  CHECK(unflattened(0, Extent{}).empty());
}

TEST_CASE("The outer axes of a study precede r1, r3 and r2") {
  const Tile tile{0, {{1, 2, 3}, {4, 5, 6}}};
  const MapShape single{Study(Job{})};
  CHECK(single.rank() == 3);
  CHECK(single.outer().empty());
  CHECK(single.extent() == Extent{99, 120, 119});
  CHECK(single.first_cell(tile) == Extent{1, 2, 3});
  CHECK(single.block(tile.block.count) == Extent{4, 5, 6});

  const MapShape shape{
      Study(parse_job("[scene]\nprojectile-mass = 1, 2\nsling-mass = 0:2:1\n", "a.cfg", {}))};
  CHECK(shape.rank() == 5);
  CHECK(shape.outer() == Extent{2, 3});
  CHECK(shape.extent() == Extent{2, 3, 99, 120, 119});
  CHECK(shape.first_cell({5, tile.block}) == Extent{1, 2, 1, 2, 3});
  CHECK(shape.block(tile.block.count) == Extent{1, 1, 4, 5, 6});
}
