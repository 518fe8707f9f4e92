#include "trebsweep/job/buildable.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

/// A machine of 60 kg whose arm starts with its tip below the ground.
Scene sunken_scene() {
  Scene scene;
  scene.counterweight_mass = 60;
  scene.projectile_mass = 0.5;
  scene.fulcrum_height = 1.1;
  scene.beam_side = 0.05;
  scene.beam_density = 700;
  scene.start_angle = 0.5;
  scene.counterweight_hanger = 0.6;
  scene.trough = true;
  return scene;
}

BuildValues values_of(const Scene& scene, const Design<double>& design) {
  Solver solver;
  solver.release = Release::farthest;
  SwingResult result;
  std::array<double, build_fields.size()> values;
  integrate(scene, solver, {{&design, 1}, {&result, 1}, build_fields, values});
  return to_build_values(values);
}

std::vector<BuildFault> faults(const Scene& scene, const BuildValues& values) {
  std::vector<BuildFault> found;
  for (const BuildProblem& problem : build_problems(scene, values)) found.push_back(problem.fault);
  return found;
}

}  // namespace

TEST_CASE("A machine whose parts stay above the ground, taut and under tension is buildable") {
  const Scene scene;
  CHECK(build_problems(scene, values_of(scene, {0.51, 0.58, 0.91})).empty());
  CHECK(build_problems(scene, {0, 0, 0, 0, 0}).empty());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();  // without a release
  CHECK(build_problems(scene, {nan, nan, nan, nan, nan}).empty());
}

TEST_CASE("Of a long arm and hanger it says by how much tip and counterweight are under ground") {
  const Scene scene = sunken_scene();
  const BuildValues values = values_of(scene, {0.9, 1, 2});
  CHECK(values.tip_clearance == Approx(1.1 - 2 * std::cos(0.5)));  // at the start
  CHECK(values.counterweight_clearance < -0.1);
  CHECK(values.counterweight_clearance > 1.1 - 0.9 - 0.6 - 1e-9);  // both hang straight down
  const auto problems = build_problems(scene, values);
  REQUIRE(problems.size() >= 2);
  CHECK(problems[0].text == "the arm's tip reaches 0.66 m below the ground");
  CHECK(problems[1].text == fmt::format("the counterweight reaches {:.2g} m below the ground",
                                        -values.counterweight_clearance));
  CHECK_THAT(to_text(problems), contains(problems[0].text + "; " + problems[1].text));
}

TEST_CASE("Heights count from one micrometre, tensions from a millionth of the weight") {
  const Scene scene = sunken_scene();
  const double weight = 0.5 * scene.gravity, heavy = 60 * scene.gravity;
  using enum BuildFault;
  CHECK(faults(scene, {-0.9e-6 * weight, -0.9e-6 * heavy, -0.9e-6, -0.9e-6, -0.9e-6}).empty());
  CHECK(faults(scene, {0, 0, -1.1e-6, 0, 0}) == std::vector{below_ground});
  CHECK(faults(scene, {0, 0, 0, -1.1e-6, 0}) == std::vector{below_ground});
  CHECK(faults(scene, {0, 0, 0, 0, -1.1e-6}) == std::vector{below_ground});
  CHECK(faults(scene, {-1.1e-6 * weight, 0, 0, 0, 0}) == std::vector{slack_sling});
  CHECK(faults(scene, {0, -1.1e-6 * heavy, 0, 0, 0}) == std::vector{compressed_hanger});
}

TEST_CASE("An elastic sling goes slack where its tension is zero") {
  Scene scene;
  scene.sling_stiffness = 1e5;
  CHECK(faults(scene, {1e-9, 0, 0, 0, 0}).empty());
  const auto problems = build_problems(scene, {0, 0, 0, 0, 0});
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].fault == BuildFault::slack_sling);
  CHECK(problems[0].text == "the sling goes slack");
}
