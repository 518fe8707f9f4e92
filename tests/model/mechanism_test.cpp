#include "trebsweep/model/mechanism.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using namespace trebsweep::test;
namespace autodiff = boost::math::differentiation;

namespace {

/// Second-order Taylor polynomials of the coordinates in time, for automatic differentiation.
template <Effects E>
auto path(const Sample<E>& s, const State<double, E>& dxdt) {
  const auto t = autodiff::make_fvar<double, 2>(0);
  const auto q1 = s.x[phi1] + s.x[w1] * t + 0.5 * dxdt[w1] * t * t;
  const auto q2 = s.x[phi2] + s.x[w2] * t + 0.5 * dxdt[w2] * t * t;
  auto l = s.sling_length() + 0 * t;
  if constexpr (E.elastic) l = l + s.x[stretching] * t + 0.5 * dxdt[stretching] * t * t;
  return positions(s.design, q1, q2, l);
}

}  // namespace

TEST_CASE("Kinetic minus potential energy is the Lagrangian") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(1);
    for (int i = 0; i < 100; ++i) {
      const auto s = random_sample<E>(random);
      const Mechanism<double, E> mechanism(s.scene, s.design);
      const double kinetic = mechanism.kinetic_energy(s.x);
      const double potential = mechanism.potential_energy(s.x);
      const double L = lagrangian(s.scene, s.design, s.x[phi1], s.x[phi2], s.sling_length(),
                                  s.x[w1], s.x[w2], s.sling_rate());
      const double stretch = std::max(0.0, s.sling_length() - s.design.r3);
      const double spring = s.scene.sling_stiffness * stretch * stretch / 2;
      REQUIRE(std::abs(kinetic - potential - L) < 1e-12 * (kinetic + std::abs(potential)));
      REQUIRE(mechanism.energy(s.x) == Approx(kinetic + potential + spring).epsilon(1e-14));
    }
  });
}

TEST_CASE("The energy decreases at the rate of the dissipation") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
      const auto s = random_sample<E>(random);
      const Mechanism<double, E> mechanism(s.scene, s.design);
      const auto dxdt = rates(s);
      const auto energy_after = [&](double t) {
        auto x = s.x;
        for (std::size_t k = 0; k < x.size(); ++k) x[k] += t * dxdt[k];
        return mechanism.energy(x);
      };
      const double h = 1e-6;
      const double rate = (energy_after(h) - energy_after(-h)) / (2 * h);
      const double scale = mechanism.energy(s.x) + mechanism.kinetic_energy(s.x) * 1e2 +
                           s.scene.sling_stiffness * 10;
      REQUIRE(std::abs(rate + mechanism.dissipation(s.x)) < 1e-6 * std::abs(scale));
      REQUIRE(mechanism.dissipation(s.x) >= 0);
    }
  });
}

TEST_CASE("Positions, speed and sling tension follow from the path of the projectile") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(2);
    for (int i = 0; i < 100; ++i) {
      const auto s = random_sample<E>(random);
      const Mechanism<double, E> mechanism(s.scene, s.design);
      const auto dxdt = rates(s);
      const auto at = path(s, dxdt);
      REQUIRE(mechanism.projectile(s.x).x == Approx(at.x3.derivative(0)));
      REQUIRE(mechanism.projectile(s.x).y == Approx(at.y3.derivative(0)));
      REQUIRE(mechanism.velocity(s.x).x == Approx(at.x3.derivative(1)).margin(1e-12));
      REQUIRE(mechanism.velocity(s.x).y == Approx(at.y3.derivative(1)).margin(1e-12));
      const double speed = std::hypot(at.x3.derivative(1), at.y3.derivative(1));
      REQUIRE(mechanism.speed(s.x) == Approx(speed).epsilon(1e-12));

      // Newton: m3 a = weight + tension along the sling, towards the arm's tip.
      const double m3 = s.scene.projectile_mass;
      const double fx = m3 * at.x3.derivative(2);
      const double fy = m3 * (at.y3.derivative(2) + s.scene.gravity);
      const double sx = std::sin(s.x[phi2]), sy = std::cos(s.x[phi2]);
      const auto loads = mechanism.loads(s.x, dxdt);
      const double scale = m3 * s.scene.gravity + std::hypot(fx, fy) + s.tension();
      if (E.elastic)
        REQUIRE(std::abs(loads.projectile_tension - s.tension()) < 1e-10 * scale);
      else
        REQUIRE(std::abs(loads.projectile_tension - (fx * sx + fy * sy)) < 1e-10 * scale);
      if (s.scene.sling_mass == 0) {
        REQUIRE(std::abs(fx * sx + fy * sy - loads.projectile_tension) < 1e-9 * scale);
        REQUIRE(std::abs(loads.tip_tension - loads.projectile_tension) < 1e-9 * scale);
        REQUIRE(std::abs(fx * sy - fy * sx) < 1e-9 * scale);  // no transverse force
      }
    }
  });
}

TEST_CASE("The axle load is the sum of weights and inertial forces of all masses") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(5);
    for (int i = 0; i < 100; ++i) {
      const auto s = random_sample<E>(random);
      const Mechanism<double, E> mechanism(s.scene, s.design);
      const auto dxdt = rates(s);
      const auto at = path(s, dxdt);
      const double per_metre = s.scene.beam_density * s.scene.beam_side * s.scene.beam_side;
      const double m2 = per_metre * (s.design.r1 + s.design.r2);
      const double centre = (s.design.r1 - s.design.r2) / (2 * s.design.r1);  // of counterweight's
      const auto force = [&](const auto& p1, const auto& pt, const auto& p3, double g) {
        const auto weigh = [&](double m, double a) { return m * (a + g); };
        return weigh(s.scene.counterweight_mass, p1.derivative(2)) +
               weigh(m2, centre * p1.derivative(2)) +
               weigh(s.scene.projectile_mass, p3.derivative(2)) +
               weigh(s.scene.sling_mass, (pt.derivative(2) + p3.derivative(2)) / 2);
      };
      const double fx = force(at.x1, at.xt, at.x3, 0);
      const double fy = force(at.y1, at.yt, at.y3, s.scene.gravity);
      REQUIRE(mechanism.loads(s.x, dxdt).axle == Approx(std::hypot(fx, fy)).epsilon(1e-9));
    }
  });
}

TEST_CASE("The bending moment balances on both sides of the fulcrum") {
  // A frictionless pivot transmits no torque, so that the bending moments of both arms are equal.
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    auto s = random_sample<Effects{}>(random);
    s.scene.beam_inertia = BeamInertia::slender;
    const Mechanism<double> mechanism(s.scene, s.design);
    const auto dxdt = rates(s);
    const double side = s.scene.beam_side, per_metre = s.scene.beam_density * side * side;
    const double r1 = s.design.r1, sine = std::sin(s.x[phi1]), g = s.scene.gravity;
    const double m1 = s.scene.counterweight_mass;
    const double moment = (m1 * r1 * r1 + per_metre * r1 * r1 * r1 / 3) * dxdt[w1] -
                          (m1 * g * r1 + per_metre * g * r1 * r1 / 2) * sine;
    const double stress = 6 * std::abs(moment) / (side * side * side);
    const double scale = 6 * m1 * r1 * (g + r1 * std::abs(dxdt[w1])) / (side * side * side);
    REQUIRE(std::abs(std::abs(mechanism.loads(s.x, dxdt).beam_stress) - stress) < 1e-10 * scale);
  }
}

TEST_CASE("A horizontal beam in equilibrium bends like a cantilever") {
  Scene scene;
  scene.beam_density = 0;
  const Mechanism<double> mechanism(scene, {1, 1, 2});
  // Level: phi1 = pi/2, the sling hangs; nothing accelerates.
  const State<double> x{boost::math::double_constants::half_pi, 0, 0, 0}, still{};
  const auto loads = mechanism.loads(x, still);
  CHECK(loads.projectile_tension == Approx(100 * 9.8));
  CHECK(loads.axle == Approx(5100 * 9.8));
  CHECK(loads.beam_stress == Approx(6 * 100 * 9.8 * 2 / 1e-3));
}

TEST_CASE("Sling and arms have their lengths in every state") {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const auto s = random_sample<Effects{}>(random);
    const Mechanism<double> mechanism(s.scene, s.design);
    const auto c = mechanism.counterweight(s.x), tip = mechanism.arm_tip(s.x),
               p = mechanism.projectile(s.x);
    REQUIRE(std::hypot(c.x, c.y) == Approx(s.design.r1).epsilon(1e-14));
    REQUIRE(std::hypot(tip.x, tip.y) == Approx(s.design.r2).epsilon(1e-14));
    REQUIRE(std::hypot(p.x - tip.x, p.y - tip.y) == Approx(s.design.r3).epsilon(1e-13));
    REQUIRE(c.x * tip.y == Approx(c.y * tip.x).margin(1e-14));
  }
}

TEST_CASE("A swing starts at rest with the counterweight at height h") {
  for (const double h : {1.0, 1.4, 1.5, 1.7, 2.0}) {
    Scene scene;
    scene.release_height = h;
    scene.sling_angle = 0.25;
    const Mechanism<double> mechanism(scene, {0.51, 0.58, 0.91});
    const State<double> x = start<double>(scene, {0.51, 0.58, 0.91});
    REQUIRE(mechanism.counterweight(x).y == Approx(h - scene.fulcrum_height).margin(1e-15));
    REQUIRE(mechanism.counterweight(x).x >= 0);
    REQUIRE(x[phi2] == 0.25);
    REQUIRE(mechanism.kinetic_energy(x) == 0);
  }
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
  REQUIRE(start_is_reachable(scene, 0.5));
  REQUIRE(start_is_reachable(scene, 0.51));
  REQUIRE_FALSE(start_is_reachable(scene, 0.49));
  scene.release_height = 0.5;
  REQUIRE(start_is_reachable(scene, 1.0));
  REQUIRE_FALSE(start_is_reachable(scene, 0.99));
  scene.release_height = 1.6;  // 1.6 - 1.5 is not quite 0.1
  REQUIRE(start_is_reachable(scene, 0.1));
}
