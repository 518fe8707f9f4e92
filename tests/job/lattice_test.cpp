#include "trebsweep/job/lattice.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/model/start.hpp"

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

TEST_CASE("A counterweight on a hanger starts at its height and clears the ground") {
  Scene scene;  // h = 2 m, h0 = 1.5 m
  scene.counterweight_hanger = 0.3;
  const Lattice lattice(scene, {});
  CHECK(lattice.axes()[0].front() == 0.81);  // h - h0 + r4 = 0.8 m
  CHECK(lattice.axes()[0].back() == 1.19);   // h0 - r4 = 1.2 m
  CHECK(lattice.axes()[1] == Lattice(Scene{}, {}).axes()[1]);
  CHECK(lattice.axes()[2] == Lattice(Scene{}, {}).axes()[2]);
  scene.release_height = 1;  // below the fulcrum
  CHECK(Lattice(scene, {}).axes()[0].front() == 0.01);
}

TEST_CASE("With a start angle r1 has no lower bound but 0") {
  Scene scene;
  scene.start_angle = 0.9;
  CHECK(Lattice(scene, {}).axes()[0].front() == 0.01);
  CHECK(Lattice(scene, {}).axes()[0].back() == 1.49);
  scene.counterweight_hanger = 0.5;
  CHECK(Lattice(scene, {}).axes()[0].front() == 0.01);
  CHECK(Lattice(scene, {}).axes()[0].back() == 0.99);
}

TEST_CASE("The message about a hanger that leaves no design names the key to change") {
  Scene scene;
  scene.counterweight_hanger = 0.6;
  CHECK_THROWS_WITH(
      Lattice(scene, {}),
      contains(
          "scene.release-height = 2 leaves no design: r1 must be longer than h - h0 + r4 = 1.1 "
          "m and shorter than h0 - r4 = 0.9 m (47)") &&
          contains("choose a height below 1.8 m"));
  scene.release_height = 1.75;
  CHECK(Lattice(scene, {}).designs() > 0);
  scene.counterweight_hanger = 1.5;
  CHECK_THROWS_WITH(Lattice(scene, {}),
                    contains("scene.counterweight-hanger = 1.5 leaves no design") &&
                        contains("shorter than h0 - r4 = 0 m (47)"));
  scene.start_angle = 0.9;
  CHECK_THROWS_WITH(Lattice(scene, {}), contains("r1 must be longer than 0 m"));
}

TEST_CASE("With a trough, r3 and r2 have by default an axis around the fulcrum's height") {
  Scene scene;
  scene.trough = true;
  scene.start_angle = 0.8;
  for (const double h0 : {0.0123, 0.3, 0.831, 1.5, 1.51, 5.5, 8.0, 299.0}) {
    INFO(h0);
    scene.fulcrum_height = h0;
    const LatticeSpec spec = with_trough_axes({}, false, h0, h0);
    const Lattice lattice(scene, spec);
    for (const std::size_t axis : {1, 2}) {
      CHECK(lattice.axes()[axis].front() == Approx(0.4 * h0).margin(spec.increment / 2));
      CHECK(lattice.axes()[axis].back() == Approx(2.2 * h0).margin(spec.increment / 2));
      CHECK(lattice.axes()[axis][1] - lattice.axes()[axis][0] == Approx(spec.increment));
    }
    CHECK(lattice.designs() > 10'000);
    CHECK(lattice.designs() < 100'000);
  }
  CHECK(with_trough_axes({}, false, 1.5, 1.5).increment == 0.05);
  CHECK(with_trough_axes({}, false, 0.831, 0.831).increment == 0.03);
}

TEST_CASE(
    "By default most slings reach a trough, which none does within the bounds (48) and (49)") {
  Scene scene;
  scene.start_angle = 0.8;
  const auto reaching = [&](const LatticeSpec& spec) {
    const Lattice lattice(scene, spec);
    const auto [n1, n3, n2] = lattice.extent();
    std::uint64_t count = 0;
    for (std::size_t i3 = 0; i3 < n3; ++i3)
      for (std::size_t i2 = 0; i2 < lattice.row_length(i3); ++i2)
        count += sling_reaches_trough(scene, lattice.design({0, i3, i2}));
    return static_cast<double>(count * n1) / static_cast<double>(lattice.designs());
  };
  scene.trough = true;
  CHECK(reaching({}) == 0);
  CHECK(reaching(with_trough_axes({}, false, 1.5, 1.5)) > 0.9);
}

TEST_CASE("With a trough, given axes and a given increment are kept") {
  LatticeSpec spec = with_increment(0.07);
  spec.r3 = AxisRange{1.2, 1.4, 0.1};
  const LatticeSpec one = with_trough_axes(spec, true, 1.5, 1.5);
  CHECK(one.increment == 0.07);
  CHECK(one.r3->last == 1.4);
  CHECK(one.r2->step == 0.07);
  CHECK_FALSE(one.r1);
  spec.r2 = AxisRange{1, 1.3, 0.1};
  const LatticeSpec both = with_trough_axes(spec, false, 1.5, 1.5);
  CHECK(both.increment == 0.07);
  CHECK(both.r2->last == 1.3);
}

TEST_CASE("A step that is too short for a trough's axes is refused as the increment") {
  Scene scene;
  scene.trough = true;
  const LatticeSpec spec = with_trough_axes(with_increment(1e-9), true, 1.5, 1.5);
  CHECK_THROWS_WITH(Lattice(scene, spec),
                    contains("lattice.increment = 1e-09") && contains("cells"));
}

TEST_CASE("A lattice that is too large is refused, with its size, before it is stored") {
  CHECK_THROWS_WITH(
      Lattice(Scene{}, with_increment(1e-9)),
      contains("lattice.increment = 1e-09 would make a lattice of ") && contains("1e+12 cells"));
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
