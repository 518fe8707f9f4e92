#include "trebsweep/model/start.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using namespace trebsweep::test;

TEST_CASE("A swing starts at rest with the counterweight at height h, also on a hanger") {
  const auto check = []<Effects E>(double h, double hanger) {
    Scene scene;
    scene.release_height = h;
    scene.counterweight_hanger = hanger;
    scene.sling_angle = 0.25;
    const Mechanism<double, E> mechanism(scene, {0.51, 0.58, 0.91});
    const auto x = start<double, E>(scene, {0.51, 0.58, 0.91});
    REQUIRE(mechanism.counterweight(x).y == Approx(h - scene.fulcrum_height).margin(1e-15));
    REQUIRE(mechanism.counterweight(x).x >= 0);
    REQUIRE(x[phi2] == 0.25);
    REQUIRE(mechanism.kinetic_energy(x) == 0);
    if constexpr (E.hanger) REQUIRE(x[phi3] == 0);
  };
  for (const double h : {1.0, 1.4, 1.5, 1.7, 2.0}) {
    check.operator()<Effects{}>(h, 0);
    check.operator()<Effects{.hanger = true}>(h - 0.3, 0.3);
  }
}

TEST_CASE("A start angle replaces the release height") {
  for_all_effects([]<Effects E>() {
    Scene scene;
    scene.start_angle = 2.5;
    scene.release_height = 100;  // out of reach
    scene.sling_stiffness = 1e6;
    REQUIRE(start_is_reachable(scene, {0.1, 1, 1}));
    REQUIRE(start<double, E>(scene, {0.1, 2, 0.5})[phi1] == 2.5);
  });
}

TEST_CASE("The arm's tip starts at the height that is given") {
  for_all_effects([]<Effects E>() {
    Scene scene;
    scene.sling_stiffness = 1e6;
    scene.release_height = 100;  // out of reach
    for (const double height : {0.0, 0.3, 1.5, 2.4}) {
      scene.start_tip_height = height;
      const Design<double> design{0.4, 3, 1.6};
      REQUIRE(start_is_reachable(scene, design));
      const auto tip = Mechanism<double, E>(scene, design).arm_tip(start<double, E>(scene, design));
      REQUIRE(tip.y + scene.fulcrum_height == Approx(height).margin(1e-15));
      REQUIRE(tip.x <= 0);
    }
    REQUIRE_FALSE(start_is_reachable(scene, {2, 3, 0.89}));
    REQUIRE(start_is_reachable(scene, {0.1, 3, 0.9}));  // 2.4 - 1.5 is not quite 0.9
  });
}

TEST_CASE("In the trough, the sling starts taut under the counterweight's side, at rest") {
  std::mt19937 random(9);
  for_all_effects([&]<Effects E>() {
    if constexpr (E.trough)
      for (int i = 0; i < 100; ++i) {
        auto [scene, d, unused] = random_sample<E>(random);
        scene.sling_angle = 0.7;  // without effect
        scene.start_angle = std::uniform_real_distribution<double>(0, 3.14)(random);
        const double above = start_above_trough(scene, d);
        const double tip = scene.fulcrum_height - d.r2 * std::cos(*scene.start_angle);
        REQUIRE(above == Approx(tip - scene.trough_height).margin(1e-14));
        // Also from a tip below the trough.
        d.r3 = std::abs(above) * std::uniform_real_distribution<double>(1, 2)(random);
        REQUIRE(sling_reaches_trough(scene, d));
        const auto x = start<double, E>(scene, d);
        const Mechanism<double, E> mechanism(scene, d);
        const double height = mechanism.projectile(x).y + scene.fulcrum_height;
        REQUIRE(height == Approx(scene.trough_height).margin(1e-14));
        REQUIRE(mechanism.projectile(x).x > mechanism.arm_tip(x).x);
        REQUIRE(x[phi2] < 0);
        REQUIRE(x[phi1] == *scene.start_angle);
        REQUIRE(mechanism.kinetic_energy(x) == 0);
        if constexpr (E.hanger) REQUIRE(x[phi3] == 0);
      }
  });
}

TEST_CASE("A sling reaches the trough if it is as long as the arm's tip is high above it") {
  Scene scene;
  scene.fulcrum_height = 3;
  scene.start_angle = 0;  // the tip is at a height of 3 - 2
  REQUIRE(sling_reaches_trough(scene, {1, 0.01, 2}));
  scene.trough = true;
  for (const double trough : {0.25, 1.75}) {  // above and below the tip
    scene.trough_height = trough;
    REQUIRE(start_above_trough<double>(scene, {1, 1, 2}) == 1 - trough);
    REQUIRE(sling_reaches_trough(scene, {1, 0.75, 2}));
    REQUIRE_FALSE(sling_reaches_trough(scene, {1, 0.75 * (1 - 1e-11), 2}));
  }
  scene.trough_height = 0.4;  // 3 - 0.4 - 2 is not quite 0.6
  REQUIRE(start_above_trough<double>(scene, {1, 1, 2}) > 0.6);
  REQUIRE(sling_reaches_trough(scene, {1, 0.6, 2}));
  REQUIRE(start<double, Effects{.trough = true}>(scene, {1, 0.6, 2})[phi2] == 0);
}

TEST_CASE("A counterweight that starts at its lowest point up to rounding starts at phi1 = pi") {
  Scene scene;
  scene.release_height = 1.4;  // 1.4 - 1.5 is not quite -0.1
  CHECK(start<double>(scene, {0.1, 0.5, 0.9})[phi1] == Approx(3.14159265358979));
}

TEST_CASE("The initial angle is accurate near the upright position") {
  const Scene scene;  // h - h0 = 0.5
  for (const double above : {1e-3, 1e-6, 1e-9}) {
    const double r1 = 0.5 + above;
    const double exact_to_third_order = std::sqrt(2 * (r1 - 0.5) / r1);  // 1 - cos(a) = a^2/2 - ...
    const double angle = start<double>(scene, {r1, 1, 1})[phi1];
    REQUIRE(angle == Approx(exact_to_third_order).epsilon(above));
  }
  REQUIRE(start<double>(scene, {0.5, 1, 1})[phi1] == 0);
}

TEST_CASE("An arm shorter than |h - h0| cannot start") {
  Scene scene;
  REQUIRE(start_is_reachable(scene, {0.5, 1, 1}));
  REQUIRE(start_is_reachable(scene, {0.51, 1, 1}));
  REQUIRE_FALSE(start_is_reachable(scene, {0.49, 1, 1}));
  scene.release_height = 0.5;
  REQUIRE(start_is_reachable(scene, {1.0, 1, 1}));
  REQUIRE_FALSE(start_is_reachable(scene, {0.99, 1, 1}));
  scene.release_height = 1.6;  // 1.6 - 1.5 is not quite 0.1
  REQUIRE(start_is_reachable(scene, {0.1, 1, 1}));
  scene.counterweight_hanger = 0.5;  // raises the hinge
  REQUIRE(start_is_reachable(scene, {0.6, 1, 1}));
  REQUIRE_FALSE(start_is_reachable(scene, {0.59, 1, 1}));
}
