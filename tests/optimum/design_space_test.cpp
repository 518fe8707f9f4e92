#include "trebsweep/optimum/design_space.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("The bounds are those of the lattice, (47)-(49), and of explicit axes") {
  Job job;
  LatticeSpec& spec = job.lattice;
  const DesignSpace paper = design_space(job);
  CHECK(paper.lower == Eigen::Vector3d(0.5, 0.3, 0.0));
  CHECK(paper.upper == Eigen::Vector3d(1.5, 1.5, 1.5));
  REQUIRE(paper.limits.size() == 1);
  CHECK(paper.limits[0].text == "r2 + r3 <= 1.5");
  CHECK(paper.limits[0].excess(job.scene, {0.6, 0.75, 1}) == 0.25);
  spec.r1 = AxisRange{0.6, 0.9, 0.1};
  spec.r3 = AxisRange{0.4, 0.4, 1};
  const DesignSpace explicit_r1_r3 = design_space(job);
  CHECK(explicit_r1_r3.lower == Eigen::Vector3d(0.6, 0.4, 0.0));
  CHECK(explicit_r1_r3.upper == Eigen::Vector3d(0.9, 0.4, 1.5));
  CHECK(explicit_r1_r3.limits.size() == 1);
  spec.r2 = AxisRange{0.5, 3, 0.1};
  const DesignSpace box = design_space(job);
  CHECK(box.upper == Eigen::Vector3d(0.9, 0.4, 3.0));
  CHECK(box.limits.empty());
}

TEST_CASE("A fine lattice lies within the design space and comes close to each bound") {
  Scene hanger;
  hanger.counterweight_hanger = 0.2;
  Scene start_angle = hanger;
  start_angle.start_angle = 1;
  for (const Scene& scene : {Scene{}, hanger, start_angle}) {
    Job job;
    job.scene = scene;
    LatticeSpec& spec = job.lattice;
    spec.shortest_sling = 0.25;
    const DesignSpace space = design_space(job);
    const Lattice lattice(scene, spec);
    double largest_excess = -1;
    for (std::size_t i3 = 0; i3 < lattice.extent()[1]; ++i3) {
      if (lattice.row_length(i3) == 0) continue;
      const Design<double> design = lattice.design({0, i3, lattice.row_length(i3) - 1});
      largest_excess = std::max(largest_excess, space.limits[0].excess(scene, design));
    }
    CHECK(largest_excess <= 0);
    CHECK(largest_excess > -1.001 * spec.increment);
    for (std::size_t d = 0; d < 3; ++d) {
      const std::vector<double>& axis = lattice.axes()[d];
      const auto i = static_cast<Eigen::Index>(d);
      CHECK(axis.front() >= space.lower(i));
      CHECK(axis.back() <= space.upper(i));
      CHECK(axis.front() < space.lower(i) + 1.001 * spec.increment);
      if (d < 2) CHECK(axis.back() > space.upper(i) - 2.001 * spec.increment);
    }
  }
}

TEST_CASE("An empty design space names the length and its bounds") {
  Job high;
  high.scene.release_height = 3.5;
  CHECK_THROWS_WITH(design_space(high), contains("r1 must be longer than h - h0 = 2 m") &&
                                            contains("shorter than h0 = 1.5 m"));
  Job long_sling;
  long_sling.lattice.shortest_sling = 1.6;
  CHECK_THROWS_WITH(design_space(long_sling),
                    contains("r3 must be longer than lattice.shortest-sling = 1.6 m"));
}

TEST_CASE("A design is printed to 0.1 micrometres, in the order r1, r2, r3") {
  CHECK(to_text(to_parameters({0.51142299, 0.58339719, 0.91660281}), {}) ==
        "r1 = 0.5114230, r2 = 0.9166028, r3 = 0.5833972 m");
}

TEST_CASE("Bounds that depend on a variable become limits, which are those of each scene") {
  const Job job = job_with({{"optimum.variables", "fulcrum-height 1.2:1.8, release-height 1:2.2"}});
  const DesignSpace space = design_space(job);
  CHECK(space.names ==
        std::vector<std::string>{"r1", "r3", "r2", "fulcrum-height", "release-height"});
  CHECK(space.units == std::vector<std::string>(5, "m"));
  CHECK(space.lower(0) == 0);  // h - h0 < 0 in some scenes
  CHECK(space.upper(0) == 1.8);
  std::vector<std::string> texts;
  for (const SpaceLimit& limit : space.limits) texts.push_back(limit.text);
  CHECK(texts == std::vector<std::string>{"r1 >= h - h0", "r1 <= h0", "r2 + r3 <= h0"});
  for (const double h0 : {1.2, 1.5, 1.8})
    for (const double h : {1.0, 1.9, 2.2}) {
      Scene scene = job.scene;
      scene.fulcrum_height = h0;
      scene.release_height = h;
      const ArmBounds arm = arm_bounds(scene);
      CHECK(space.limits[0].excess(scene, {arm.low, 0.5, 0.5}) == 0);
      CHECK(space.limits[1].excess(scene, {arm.high, 0.5, 0.5}) == 0);
      CHECK(space.limits[2].excess(scene, {1, 0.5, h0}) == Approx(0.5));
    }
  CHECK(design_space(job_with({{"optimum.variables", "gravity 9:10"}})).limits.size() == 1);
}
