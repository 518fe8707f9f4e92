#include "trebsweep/sweep/compute.hpp"

#include "support/catch.hpp"
#include "support/small_archive.hpp"

using namespace trebsweep;

TEST_CASE("The lanes make at least the steps of the designs of a tile, and few more", "[alone]") {
  for (const SmallStudy& small : small_studies()) {
    Compute compute(small.study);
    Tally sum;
    for (std::uint64_t t = 0; t < small.tiling.size(); ++t) {
      const Tile tile = small.tiling.tile(t);
      const Tally tally = compute.tile(tile, [] {}).tally;
      CHECK(tally.designs() == small.study.lattice(tile.scene).designs_in(tile.block));
      CHECK(tally.steps > 0);
      CHECK(tally.lane_steps >= tally.steps);
      sum.add(tally);
    }
    CHECK(sum.utilisation() > 0.4);  // of tiles of up to 60 designs
  }
}

TEST_CASE("The first designs of a sweep are integrated few at a time, with polls in between",
          "[alone]") {
  Job job = job_of_one_scene();
  job.lattice.increment = 0.05;
  const Study study(job);
  const Tile all{0, {{0, 0, 0}, study.extent()}};
  Compute compute(study);
  int polls = 0;
  const ComputedTile first = compute.tile(all, [&] { ++polls; });
  CHECK(polls > 2);
  polls = 0;
  const ComputedTile second = compute.tile(all, [&] { ++polls; });
  CHECK(polls == 1);
  CHECK(first.tally.steps == second.tally.steps);
  for (std::size_t m = 0; m < first.maps.size(); ++m)
    CHECK(std::ranges::equal(first.maps[m], second.maps[m], [](double a, double b) {
      return a == b || (std::isnan(a) && std::isnan(b));
    }));
}
