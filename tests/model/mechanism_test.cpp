#include "trebsweep/model/mechanism.hpp"

#include "model/lagrangian.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using namespace trebsweep::test;
namespace autodiff = boost::math::differentiation;

namespace {

/// Positions along the path that a state and its rates begin, with two derivatives with respect to
/// time.
template <Effects E>
auto path(const Sample<E>& s, const State<double, E>& dxdt) {
  const auto t = autodiff::make_fvar<double, 2>(0);
  const auto q1 = s.x[phi1] + s.x[w1] * t + 0.5 * dxdt[w1] * t * t;
  const auto q2 = s.x[phi2] + s.x[w2] * t + 0.5 * dxdt[w2] * t * t;
  auto q3 = s.q3() + s.v3() * t;
  if constexpr (coordinates<E> == 6) q3 = q3 + 0.5 * dxdt[5] * t * t;
  return positions(s.scene, s.design, q1, q2, q3);
}

template <Effects E>
Loads<double> loads(const Sample<E>& s, const State<double, E>& dxdt) {
  return Mechanism<double, E>(s.scene, s.design)
      .loads(s.x, directions<E>(s.x), dxdt, normal_force(s));
}

/// Requires that the energy changes at the rate of the dissipation along the rates of a motion.
template <Effects E>
void require_energy_balance(const Sample<E>& s, const Motion<double, E>& motion) {
  const Mechanism<double, E> mechanism(s.scene, s.design);
  State<double, E> dxdt;
  motion(s.x, dxdt, 0);
  const auto energy_after = [&](double t) {
    auto x = s.x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += t * dxdt[k];
    return mechanism.energy(x);
  };
  const double h = 1e-6;
  const double rate = (energy_after(h) - energy_after(-h)) / (2 * h);
  const double scale = std::abs(mechanism.potential_energy(s.x)) +
                       mechanism.kinetic_energy(s.x) * 1e2 + s.scene.sling_stiffness * 10;
  REQUIRE(std::abs(rate + mechanism.dissipation(s.x)) < 1e-6 * scale);
  REQUIRE(mechanism.dissipation(s.x) >= 0);
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
      const double L =
          lagrangian(s.scene, s.design, s.x[phi1], s.x[phi2], s.q3(), s.x[w1], s.x[w2], s.v3());
      const double spring = s.scene.sling_stiffness * s.stretch() * s.stretch() / 2;
      REQUIRE(std::abs(kinetic - potential - L) < 1e-12 * (kinetic + std::abs(potential)));
      REQUIRE(mechanism.energy(s.x) == Approx(kinetic + potential + spring).epsilon(1e-14));
    }
  });
}

TEST_CASE("The energy decreases at the rate of the dissipation, in the trough and after lift-off") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(4);
    for (int i = 0; i < 300; ++i) {
      auto s = random_sample<E>(random);
      auto lifted = motion(s);
      lifted.set_sliding(0);
      require_energy_balance(s, lifted);
      if constexpr (E.trough) {
        // The normal force does no work on a projectile whose height does not change.
        s.x[phi2] = std::uniform_real_distribution<double>(-3, -0.14)(random);
        s.x[w2] =
            -s.design.r2 * std::sin(s.x[phi1]) * s.x[w1] / (s.design.r3 * std::sin(s.x[phi2]));
        REQUIRE(Mechanism<double, E>(s.scene, s.design).velocity(s.x).y == Approx(0).margin(1e-12));
        require_energy_balance(s, motion(s));
      }
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
      const double acceleration = std::hypot(at.x3.derivative(2), at.y3.derivative(2));
      const auto specific = mechanism.specific_force(s.x, directions<E>(s.x), dxdt);
      const double rounding = 1e-9 * (acceleration + s.scene.gravity);
      REQUIRE(std::abs(specific.x - at.x3.derivative(2)) < rounding);
      REQUIRE(std::abs(specific.y - at.y3.derivative(2) - s.scene.gravity) < rounding);

      // Newton: m3 a = weight + normal force + tension along the sling, towards the arm's tip.
      const double m3 = s.scene.projectile_mass, normal = normal_force(s);
      const double fx = m3 * at.x3.derivative(2);
      const double fy = m3 * (at.y3.derivative(2) + s.scene.gravity) - normal;
      const double sx = std::sin(s.x[phi2]), sy = std::cos(s.x[phi2]);
      const auto load = loads(s, dxdt);
      const double scale =
          m3 * s.scene.gravity + std::hypot(fx, fy) + s.tension() + std::abs(normal);
      if (E.elastic)
        REQUIRE(std::abs(load.projectile_tension - s.tension()) < 1e-10 * scale);
      else
        REQUIRE(std::abs(load.projectile_tension - (fx * sx + fy * sy)) < 1e-10 * scale);
      if (s.scene.sling_mass == 0) {
        REQUIRE(std::abs(fx * sx + fy * sy - load.projectile_tension) < 1e-9 * scale);
        REQUIRE(std::abs(load.tip_tension - load.projectile_tension) < 1e-9 * scale);
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
      const auto dxdt = rates(s);
      const auto at = path(s, dxdt);
      const double moment = beam(s.scene, s.design).moment / -s.design.r2;  // moves like the tip
      const auto force = [&](const auto& p1, const auto& pt, const auto& p3) {
        return s.scene.counterweight_mass * p1.derivative(2) + moment * pt.derivative(2) +
               s.scene.projectile_mass * p3.derivative(2) +
               s.scene.sling_mass * (pt.derivative(2) + p3.derivative(2)) / 2;
      };
      const double mass = s.scene.counterweight_mass + beam(s.scene, s.design).mass +
                          s.scene.projectile_mass + s.scene.sling_mass;
      const double fx = force(at.x1, at.xt, at.x3);
      const double fy = force(at.y1, at.yt, at.y3) + mass * s.scene.gravity - normal_force(s);
      REQUIRE(loads(s, dxdt).axle == Approx(std::hypot(fx, fy)).epsilon(1e-9));
    }
  });
}

TEST_CASE("The hanger's tension is the force along it, and the only one that does not turn it") {
  for_all_effects([]<Effects E>() {
    std::mt19937 random(8);
    for (int i = 0; i < 100; ++i) {
      const auto s = random_sample<E>(random);
      const auto dxdt = rates(s);
      const double tension = loads(s, dxdt).hanger_tension;
      if constexpr (E.hanger) {
        const auto at = path(s, dxdt);
        const double m1 = s.scene.counterweight_mass;
        const double fx = m1 * at.x1.derivative(2);
        const double fy = m1 * (at.y1.derivative(2) + s.scene.gravity);
        const double scale = 1e-9 * (std::hypot(fx, fy) + std::abs(normal_force(s)));
        const double sine = std::sin(s.x[phi3]), cosine = std::cos(s.x[phi3]);
        REQUIRE(std::abs(fx * sine + fy * cosine - tension) < scale);
        // The transverse force at the hinge turns the counterweight about its centre.
        const double torque = s.scene.counterweight_hanger * (fx * cosine - fy * sine);
        REQUIRE(std::abs(torque - s.scene.counterweight_inertia * dxdt[w3]) <
                scale * s.scene.counterweight_hanger);
      } else {
        REQUIRE(tension == 0);
      }
    }
  });
}

TEST_CASE("The bending moment balances on both sides of the fulcrum") {
  // A frictionless pivot transmits no torque, so that the bending moments of both arms are equal.
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    auto s = random_sample<Effects{}>(random);
    s.scene = with_computed_beam(s.scene);
    s.scene.beam_inertia = BeamInertia::slender;
    const Mechanism<double> mechanism(s.scene, s.design);
    const auto dxdt = rates(s);
    const auto [width, depth] = beam_section(s.scene);
    const double per_metre = s.scene.beam_density * width * depth;
    const double r1 = s.design.r1, sine = std::sin(s.x[phi1]), g = s.scene.gravity;
    const double m1 = s.scene.counterweight_mass;
    const double inertia = m1 * r1 * r1 + s.scene.counterweight_inertia;
    const double moment = (inertia + per_metre * r1 * r1 * r1 / 3) * dxdt[w1] -
                          (m1 * g * r1 + per_metre * g * r1 * r1 / 2) * sine;
    const double modulus = width * depth * depth / 6;
    const double stress = std::abs(moment) / modulus;
    const double scale = (m1 * g * r1 + inertia * std::abs(dxdt[w1])) / modulus;
    REQUIRE(
        std::abs(std::abs(mechanism.loads(s.x, directions<Effects{}>(s.x), dxdt, 0).beam_stress) -
                 stress) < 1e-10 * scale);
  }
}

TEST_CASE("A measured beam has a bending stress if its section modulus is given") {
  Scene scene;
  scene.beam_mass = 10;
  scene.beam_centre = 0.2;
  scene.beam_moment = 5;
  const Mechanism<double> mechanism(scene, {1, 1, 2});
  const State<double> x{1, 0, 0, 0}, still{};
  const auto loads = mechanism.loads(x, directions<Effects{}>(x), still, 0);
  CHECK_FALSE(has_beam_stress(scene));
  CHECK(std::isnan(loads.beam_stress));
  CHECK(loads.axle == Approx((5000 + 10 + 100) * 9.8));

  scene.beam_section_modulus = 6.77e-5;  // a beam of 45 x 95 mm
  CHECK(has_beam_stress(scene));
  const Mechanism<double> known(scene, {1, 1, 2});
  const State<double> level{boost::math::double_constants::half_pi, 0, 0, 0};
  const double stress = known.loads(level, directions<Effects{}>(level), still, 0).beam_stress;
  CHECK(stress == Approx((100 * 2 + 10 * 0.2) * 9.8 / 6.77e-5));
}

TEST_CASE("The section modulus is that of a rectangle whose depth is in the plane of the swing") {
  Scene scene;
  scene.beam_width = 0.045;
  scene.beam_depth = 0.095;
  CHECK(1 / stress_per_moment(scene) == Approx(6.77e-5).epsilon(1e-3));
  scene.beam_width = scene.beam_depth = scene.beam_side;
  CHECK(stress_per_moment(scene) == stress_per_moment(Scene{}));
  scene.beam_side = 0;
  CHECK(has_beam_stress(scene));
  scene.beam_width = scene.beam_depth = std::nullopt;
  CHECK_FALSE(has_beam_stress(scene));
}

TEST_CASE("Sling, arms and hanger have their lengths in every state") {
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

    const auto hinged = random_sample<Effects{.hanger = true}>(random);
    const auto end = Mechanism<double, Effects{.hanger = true}>(hinged.scene, hinged.design)
                         .counterweight(hinged.x);
    const double r1 = hinged.design.r1, angle = hinged.x[phi1];
    REQUIRE(std::hypot(end.x - r1 * std::sin(angle), end.y - r1 * std::cos(angle)) ==
            Approx(hinged.scene.counterweight_hanger).epsilon(1e-13));
  }
}
