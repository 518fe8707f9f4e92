#include "trebsweep/sweep/schedule.hpp"

#include <numeric>
#include <set>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

std::uint64_t cells(const Index3& edge) { return std::uint64_t{edge[0]} * edge[1] * edge[2]; }

constexpr double fast = 1e-6;  // s per design

}  // namespace

TEST_CASE(
    "A tile is about a fifth of a small lattice along each axis, and a block of a large one") {
  CHECK(tile_edge({99, 120, 121}, 1, Maps::all, fast) == Index3{20, 24, 25});
  CHECK(tile_edge({999, 1200, 1201}, 1, Maps::all, fast) == Index3{48, 48, 48});
  CHECK(tile_edge({5, 1, 3}, 1, Maps::all, fast) == Index3{5, 1, 3});
}

TEST_CASE("Tiles divide the axes r3 and r2 evenly where an extent near a fifth does") {
  CHECK(tile_edge({99, 120, 119}, 1, Maps::all, fast) == Index3{20, 24, 17});
  CHECK(tile_edge({99, 130, 127}, 1, Maps::all, fast) == Index3{20, 26, 26});
}

TEST_CASE("A long or flat lattice has fewer than 10,000 tiles") {
  for (const Index3& extent :
       {Index3{9'000'000, 1, 1}, Index3{1, 1, 9'000'000}, Index3{20'000, 1, 20'000}}) {
    const Index3 edge = tile_edge(extent, 1, Maps::all, fast);
    CHECK(cells(edge) <= 64 * 64 * 64);
    CHECK(static_cast<double>(cells(extent)) / static_cast<double>(cells(edge)) < 1e4);
  }
}

TEST_CASE("A tile takes at most a second of one core, or is a single design") {
  for (const double seconds : {1e-6, 1e-4, 1e-2, 0.3, 5.0}) {
    const Index3 edge = tile_edge({99, 120, 119}, 1, Maps::all, seconds);
    CHECK((static_cast<double>(cells(edge)) * seconds <= 1 || cells(edge) == 1));
    CHECK(static_cast<double>(cells(edge)) * seconds > std::min(0.01, 0.1 * seconds));
  }
}

TEST_CASE(
    "Without maps, a study of many scenes has one tile for each that takes less than a second") {
  const Index3 extent{49, 60, 59};
  CHECK(tile_edge(extent, 1000, Maps::none, fast) == extent);
  const Index3 few = tile_edge(extent, 12, Maps::none, fast);
  const std::uint64_t tiles = 12 * cells(extent) / cells(few);
  CHECK(tiles >= 128);
  CHECK(tiles <= 512);
  const Index3 slow = tile_edge(extent, 1000, Maps::none, 1e-4);
  CHECK(static_cast<double>(cells(slow)) * 1e-4 <= 1);
}

TEST_CASE("A study of many small lattices has one tile for each scene") {
  CHECK(tile_edge({19, 24, 23}, 10'000, Maps::all, fast) == Index3{19, 24, 23});
}
