#include "trebsweep/job/tiling.hpp"

#include <set>

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("For any edge, tiles cover every design exactly once and no tile is empty") {
  LatticeSpec spec;
  spec.increment = 0.05;
  const Lattice lattice(Scene{}, spec);
  for (const Index3& edge :
       {Index3{1, 1, 1}, Index3{16, 16, 16}, Index3{4, 7, 5}, Index3{19, 24, 1}}) {
    const Tiling tiling(lattice, edge);
    std::set<Index3> seen;
    for (std::uint64_t t = 0; t < tiling.size(); ++t) {
      const Tile tile = tiling.tile(t);
      std::uint64_t designs = 0;
      for (std::size_t a = 0; a < tile.count[0]; ++a)
        for (std::size_t b = 0; b < tile.count[1]; ++b)
          for (std::size_t c = 0; c < tile.count[2]; ++c) {
            const Index3 index{tile.first[0] + a, tile.first[1] + b, tile.first[2] + c};
            if (!lattice.holds(index)) continue;
            REQUIRE(seen.insert(index).second);
            ++designs;
          }
      REQUIRE(designs > 0);
      REQUIRE(lattice.designs_in(tile) == designs);
    }
    REQUIRE(seen.size() == lattice.designs());
  }
}
