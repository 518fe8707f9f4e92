#include "trebsweep/job/tiling.hpp"

#include <set>

#include "support/catch.hpp"
#include "support/six_scenes.hpp"

using namespace trebsweep;

TEST_CASE("For any edge, tiles cover every design exactly once and no tile is empty") {
  Job single;
  single.lattice.increment = 0.05;
  for (const Job& job : std::vector{single, job_of_six_scenes()}) {
    const Study study(job);
    for (const Index3& edge :
         {Index3{1, 1, 1}, Index3{16, 16, 16}, Index3{4, 7, 5}, Index3{19, 24, 1}}) {
      const Tiling tiling(study, edge);
      std::set<std::uint64_t> seen;
      for (std::uint64_t t = 0; t < tiling.size(); ++t) {
        const auto [scene, block] = tiling.tile(t);
        const Lattice& lattice = study.lattice(scene);
        std::uint64_t designs = 0;
        for (std::size_t a = 0; a < block.count[0]; ++a)
          for (std::size_t b = 0; b < block.count[1]; ++b)
            for (std::size_t c = 0; c < block.count[2]; ++c) {
              const Index3 index{block.first[0] + a, block.first[1] + b, block.first[2] + c};
              if (!lattice.holds(index)) continue;
              REQUIRE(seen.insert(study.cell(scene, index)).second);
              ++designs;
            }
        REQUIRE(designs > 0);
        REQUIRE(lattice.designs_in(block) == designs);
      }
      REQUIRE(seen.size() == study.designs());
    }
  }
}

TEST_CASE("The tiles of a scene are consecutive, and scenes are in their order") {
  const Study study(job_of_six_scenes());
  const Tiling tiling(study, {4, 7, 5});
  std::uint64_t next = 0;
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
    const auto [first, end] = tiling.of_scene(scene);
    CHECK(first == next);
    CHECK(end > first);
    for (std::uint64_t t = first; t < end; ++t) REQUIRE(tiling.tile(t).scene == scene);
    next = end;
  }
  CHECK(next == tiling.size());
  CHECK(tiling.of_scene(0).end <
        tiling.of_scene(2).end - tiling.of_scene(2).first);  // a taller one
}

TEST_CASE("The tiles of a scene of a study cover what they cover in the scene's own sweep") {
  const Job job = job_of_six_scenes();
  const Study study(job);
  const Tiling tiling(study, {100, 100, 1});  // one tile for each r2
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
    const Study own(job_at(job, scene));
    const Tiling own_tiling(own, {100, 100, 1});
    const auto [first, end] = tiling.of_scene(scene);
    REQUIRE(end - first == own_tiling.size());
    for (std::uint64_t t = first; t < end; ++t)
      CHECK(study.lattice(scene).designs_in(tiling.tile(t).block) ==
            own.lattice(0).designs_in(own_tiling.tile(t - first).block));
  }
}
