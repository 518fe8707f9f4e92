#include "trebsweep/optimum/design_space.hpp"

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("The bounds are those of the lattice, (47)-(49), and of explicit axes") {
  LatticeSpec spec;
  const DesignSpace paper = design_space(Scene{}, spec);
  CHECK(paper.lower == std::array{0.5, 0.3, 0.0});
  CHECK(paper.upper == std::array{1.5, 1.5, 1.5});
  CHECK(paper.longest_sum == 1.5);
  spec.r1 = AxisRange{0.6, 0.9, 0.1};
  spec.r3 = AxisRange{0.4, 0.4, 1};
  const DesignSpace explicit_r1_r3 = design_space(Scene{}, spec);
  CHECK(explicit_r1_r3.lower == std::array{0.6, 0.4, 0.0});
  CHECK(explicit_r1_r3.upper == std::array{0.9, 0.4, 1.5});
  CHECK(explicit_r1_r3.longest_sum == 1.5);
  spec.r2 = AxisRange{0.5, 3, 0.1};
  const DesignSpace box = design_space(Scene{}, spec);
  CHECK(box.upper == std::array{0.9, 0.4, 3.0});
  CHECK_FALSE(box.longest_sum);
}

TEST_CASE("A fine lattice lies within the design space and comes close to each bound") {
  Scene hanger;
  hanger.counterweight_hanger = 0.2;
  Scene start_angle = hanger;
  start_angle.start_angle = 1;
  for (const Scene& scene : {Scene{}, hanger, start_angle}) {
    LatticeSpec spec;
    spec.shortest_sling = 0.25;
    const DesignSpace space = design_space(scene, spec);
    const Lattice lattice(scene, spec);
    double longest_sum = 0;
    for (std::size_t i3 = 0; i3 < lattice.extent()[1]; ++i3) {
      if (lattice.row_length(i3) == 0) continue;
      const auto [r1, r3, r2] = lattice.design({0, i3, lattice.row_length(i3) - 1});
      longest_sum = std::max(longest_sum, r3 + r2);
    }
    CHECK(longest_sum <= *space.longest_sum);
    CHECK(longest_sum > *space.longest_sum - 1.001 * spec.increment);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::vector<double>& axis = lattice.axes()[d];
      CHECK(axis.front() >= space.lower[d]);
      CHECK(axis.back() <= space.upper[d]);
      CHECK(axis.front() < space.lower[d] + 1.001 * spec.increment);
      if (d < 2) CHECK(axis.back() > space.upper[d] - 2.001 * spec.increment);
    }
  }
}

TEST_CASE("An empty design space names the length and its bounds") {
  Scene high;
  high.release_height = 3.5;
  CHECK_THROWS_WITH(design_space(high, {}), contains("r1 must be longer than h - h0 = 2 m") &&
                                                contains("shorter than h0 = 1.5 m"));
  LatticeSpec long_sling;
  long_sling.shortest_sling = 1.6;
  CHECK_THROWS_WITH(design_space(Scene{}, long_sling),
                    contains("r3 must be longer than lattice.shortest-sling = 1.6 m"));
}

TEST_CASE("A design is printed to 0.1 micrometres, in the order r1, r2, r3") {
  CHECK(to_text(Design<double>{0.51142299, 0.58339719, 0.91660281}) ==
        "r1 = 0.5114230, r2 = 0.9166028, r3 = 0.5833972 m");
}
