#include "trebsweep/sweep/compute.hpp"

#include "support/catch.hpp"
#include "support/small_archive.hpp"

using namespace trebsweep;

TEST_CASE("The lanes make at least the steps of the designs of all tiles, and few more") {
  for (const SmallStudy& small : small_studies()) {
    std::vector<Tile> tiles;
    for (std::uint64_t t = 0; t < small.tiling.size(); ++t) tiles.push_back(small.tiling.tile(t));
    const auto computed = compute(tiles, small.study, [] { return false; });
    REQUIRE(computed.size() == tiles.size());
    Tally sum;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      const auto& [scene, block] = tiles[t];
      const Tally& tally = computed[t].tally;
      CHECK(tally.designs() == small.study.lattice(scene).designs_in(block));
      CHECK(tally.steps > 0);
      sum.add(tally);
    }
    CHECK(sum.utilisation() > 0.8);
    CHECK(sum.utilisation() < 1);
  }
}
