#include "trebsweep/job/lattice.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

LatticeSpec with_increment(double dr) {
  LatticeSpec spec;
  spec.increment = dr;
  return spec;
}

}  // namespace

TEST_CASE("The paper's lattice has 99 x 120 x 119 values and 706,860 designs") {
  const Lattice lattice(Scene{}, LatticeSpec{});
  REQUIRE(lattice.extent() == Index3{99, 120, 119});
  REQUIRE(lattice.designs() == 706860);
  CHECK(lattice.axes()[0].front() == 0.51);
  CHECK(lattice.axes()[0].back() == 1.49);
  CHECK(lattice.axes()[1].front() == 0.30);
  CHECK(lattice.axes()[1].back() == 1.49);
  CHECK(lattice.axes()[2].front() == 0.01);
  CHECK(lattice.axes()[2].back() == 1.19);
}

TEST_CASE("Axis values are the doubles nearest to their decimals") {
  const Lattice lattice(Scene{}, LatticeSpec{});
  for (std::size_t i = 0; i < 99; ++i)
    CHECK(lattice.axes()[0][i] == static_cast<double>(51 + i) / 100);
  const Lattice fine(Scene{}, with_increment(0.001));
  for (std::size_t i = 0; i < fine.extent()[2]; ++i)
    CHECK(fine.axes()[2][i] == static_cast<double>(1 + i) / 1000);
}

TEST_CASE("The lattice holds exactly the designs within the strict bounds") {
  for (const int per_metre : {5, 10, 40, 100}) {
    const Lattice lattice(Scene{}, with_increment(1.0 / per_metre));
    const auto n = lattice.extent();
    std::uint64_t designs = 0;
    for (std::size_t i3 = 0; i3 < n[1]; ++i3)
      for (std::size_t i2 = 0; i2 < n[2]; ++i2) {
        const auto steps = static_cast<double>(i3 + i2 + 1) + 0.3 * per_metre;
        const bool inside = steps < 1.5 * per_metre - 1e-6;  // (49)
        CHECK(lattice.holds({0, i3, i2}) == inside);
        designs += inside;
      }
    CHECK(lattice.designs() == n[0] * designs);
  }
}

TEST_CASE("The index of a design is the one that it was taken from") {
  const Lattice lattice(Scene{}, LatticeSpec{});
  for (const Index3& index : {Index3{0, 0, 0}, Index3{98, 0, 118}, Index3{41, 77, 13}})
    CHECK(lattice.index_of(lattice.design(index)) == index);
}

TEST_CASE("An explicit axis includes both ends and ignores its bound") {
  LatticeSpec spec;
  spec.r1 = AxisRange{0.6, 0.8, 0.05};
  const Lattice five(Scene{}, spec);
  CHECK(five.axes()[0] == std::vector<double>{0.6, 0.65, 0.7, 0.75, 0.8});

  spec.r1 = AxisRange{1, 1, 1};
  spec.r3 = AxisRange{3, 3, 1};
  spec.r2 = AxisRange{4, 4, 1};
  const Lattice single(Scene{}, spec);
  REQUIRE(single.designs() == 1);
  CHECK(single.holds({0, 0, 0}));
  CHECK(single.design({0, 0, 0}).r2 == 4);
}

TEST_CASE("A single value is kept bitwise") {
  LatticeSpec spec;
  const double odd = 0.1 + 0.2 + 0.3;
  spec.r1 = AxisRange{odd, odd, 1};
  CHECK(Lattice(Scene{}, spec).axes()[0].at(0) == odd);
}

TEST_CASE("The message about a lattice without designs names key and value") {
  Scene tower;
  tower.release_height = 3.5;
  CHECK_THROWS_WITH(Lattice(tower, {}), contains("scene.release-height = 3.5 leaves no design"));
  tower.release_height = 3;
  CHECK_THROWS_AS(Lattice(tower, {}), InputError);
  LatticeSpec spec;
  spec.shortest_sling = 1.5;
  CHECK_THROWS_WITH(Lattice(Scene{}, spec), contains("lattice.shortest-sling = 1.5"));
  CHECK_THROWS_WITH(Lattice(Scene{}, with_increment(2)), contains("lattice.increment = 2"));
  LatticeSpec sling;
  sling.r3 = AxisRange{2, 2, 1};
  CHECK_THROWS_WITH(Lattice(Scene{}, sling), contains("lattice.r3 = 2"));
}

TEST_CASE("A lattice that is too large is refused, with its size, before it is stored") {
  CHECK_THROWS_WITH(Lattice(Scene{}, with_increment(1e-9)),
                    contains("lattice.increment = 1e-09") && contains("cells"));
  for (const double tiny : {1e-300, 1e-12})
    CHECK_THROWS_WITH(Lattice(Scene{}, with_increment(tiny)), contains("lattice.increment = "));
  LatticeSpec spec;
  spec.r2 = AxisRange{0.1, 1, 1e-12};
  CHECK_THROWS_WITH(Lattice(Scene{}, spec), contains("lattice.r2"));
}

TEST_CASE("An axis too fine for distinct values is refused") {
  LatticeSpec spec;
  spec.r1 = AxisRange{1, 1.00000000000001, 1e-15};
  CHECK_THROWS_WITH(Lattice(Scene{}, spec), contains("lattice.r1 with a step = 1e-15"));
}
