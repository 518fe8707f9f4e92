#include "trebsweep/motion.hpp"

#include <boost/math/differentiation/autodiff.hpp>
#include <random>

#include "catch.hpp"

using namespace trebsweep;
namespace autodiff = boost::math::differentiation;

namespace {

/// Kinetic minus potential energy from positions and velocities of the bodies, written without the
/// closed forms of Motion: the rod's inertia about the fulcrum is the integral of its mass over its
/// length.
template <class Q1, class Q2, class V1, class V2>
auto lagrangian(const Scene& s, const Design<double>& d, const Q1& q1, const Q2& q2, const V1& v1,
                const V2& v2) {
  const double per_metre = s.beam_density * s.beam_side * s.beam_side;
  double inertia = 0;
  if (s.beam_inertia != BeamInertia::none)
    inertia = per_metre * (std::pow(d.r1, 3) + std::pow(d.r2, 3)) / 3;
  if (s.beam_inertia == BeamInertia::prism)
    inertia += per_metre * (d.r1 + d.r2) * s.beam_side * s.beam_side / 12;

  const auto vx1 = d.r1 * cos(q1) * v1;
  const auto vy1 = -d.r1 * sin(q1) * v1;
  const auto vx3 = -d.r2 * cos(q1) * v1 - d.r3 * cos(q2) * v2;
  const auto vy3 = d.r2 * sin(q1) * v1 + d.r3 * sin(q2) * v2;
  const auto kinetic = 0.5 * s.counterweight_mass * (vx1 * vx1 + vy1 * vy1) +
                       0.5 * inertia * v1 * v1 + 0.5 * s.projectile_mass * (vx3 * vx3 + vy3 * vy3);

  const auto y1 = d.r1 * cos(q1);
  const double beam_moment = per_metre * (d.r1 * d.r1 - d.r2 * d.r2) / 2;  // integral of mass x arm
  const auto y3 = -d.r2 * cos(q1) - d.r3 * cos(q2);
  const auto potential =
      s.gravity * (s.counterweight_mass * y1 + beam_moment * cos(q1) + s.projectile_mass * y3);
  return kinetic - potential;
}

struct Sample {
  Scene scene;
  Design<double> design;
  State<double> x;
};

Sample random_sample(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Sample sample;
  sample.scene.gravity = uniform(1, 20);
  sample.scene.counterweight_mass = uniform(100, 10000);
  sample.scene.projectile_mass = uniform(1, 1000);
  sample.scene.beam_density = uniform(0, 8000);
  sample.scene.beam_side = uniform(0, 0.3);
  sample.scene.beam_inertia = static_cast<BeamInertia>(random() % 3);
  sample.design = {uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2)};
  sample.x = {uniform(-6, 6), uniform(-6, 6), uniform(-10, 10), uniform(-20, 20)};
  return sample;
}

/// The accelerations by Euler and Lagrange: M a = dL/dq - (d2L/dv dq) v with M = d2L/dv2.
std::array<double, 2> accelerations(const Sample& sample) {
  const auto variables = autodiff::make_ftuple<double, 1, 1, 2, 2>(sample.x[phi1], sample.x[phi2],
                                                                   sample.x[w1], sample.x[w2]);
  const auto L = lagrangian(sample.scene, sample.design, std::get<0>(variables),
                            std::get<1>(variables), std::get<2>(variables), std::get<3>(variables));
  const auto D = [&](int q1, int q2, int v1, int v2) { return L.derivative(q1, q2, v1, v2); };
  const double m11 = D(0, 0, 2, 0), m12 = D(0, 0, 1, 1), m22 = D(0, 0, 0, 2);
  const double b1 = D(1, 0, 0, 0) - D(1, 0, 1, 0) * sample.x[w1] - D(0, 1, 1, 0) * sample.x[w2];
  const double b2 = D(0, 1, 0, 0) - D(1, 0, 0, 1) * sample.x[w1] - D(0, 1, 0, 1) * sample.x[w2];
  const double det = m11 * m22 - m12 * m12;
  return {(b1 * m22 - b2 * m12) / det, (m11 * b2 - m12 * b1) / det};
}

State<double> rates(const Sample& sample) {
  State<double> dxdt;
  Motion<double>(sample.scene, sample.design)(sample.x, dxdt, 0);
  return dxdt;
}

}  // namespace

TEST_CASE("The equations of motion are those of the Lagrangian") {
  std::mt19937 random(20100101);
  for (int i = 0; i < 1000; ++i) {
    const Sample sample = random_sample(random);
    const State<double> dxdt = rates(sample);
    const auto expected = accelerations(sample);
    // Terms cancel at some states: measure against the largest thing that can.
    const double scale = 1 + std::abs(expected[0]) + std::abs(expected[1]);
    REQUIRE(dxdt[phi1] == sample.x[w1]);
    REQUIRE(dxdt[phi2] == sample.x[w2]);
    REQUIRE(std::abs(dxdt[w1] - expected[0]) < 1e-10 * scale);
    REQUIRE(std::abs(dxdt[w2] - expected[1]) < 1e-10 * scale);
  }
}

TEST_CASE("Kinetic less potential energy is the Lagrangian") {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Sample s = random_sample(random);
    const Motion<double> motion(s.scene, s.design);
    const double kinetic = motion.kinetic_energy(s.x), potential = motion.potential_energy(s.x);
    const double L = lagrangian(s.scene, s.design, s.x[phi1], s.x[phi2], s.x[w1], s.x[w2]);
    REQUIRE(std::abs(kinetic - potential - L) < 1e-12 * (kinetic + std::abs(potential)));
    REQUIRE(motion.energy(s.x) == kinetic + potential);
  }
}

TEST_CASE("Speed and tension follow from the projectile's path") {
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Sample s = random_sample(random);
    const Motion<double> motion(s.scene, s.design);
    const State<double> dxdt = rates(s);
    // The path to second order in time, differentiated automatically.
    const auto t = autodiff::make_fvar<double, 2>(0);
    const auto q1 = s.x[phi1] + s.x[w1] * t + 0.5 * dxdt[w1] * t * t;
    const auto q2 = s.x[phi2] + s.x[w2] * t + 0.5 * dxdt[w2] * t * t;
    const auto x3 = -(s.design.r2 * sin(q1) + s.design.r3 * sin(q2));
    const auto y3 = -(s.design.r2 * cos(q1) + s.design.r3 * cos(q2));
    REQUIRE(motion.projectile(s.x).x == Approx(x3.derivative(0)));
    REQUIRE(motion.projectile(s.x).y == Approx(y3.derivative(0)));

    const double speed = std::hypot(x3.derivative(1), y3.derivative(1));
    REQUIRE(motion.speed(s.x) == Approx(speed).epsilon(1e-12));

    // Newton: m3 a = weight + tension along the sling, towards the arm's tip; nothing across it.
    const double m3 = s.scene.projectile_mass;
    const double fx = m3 * x3.derivative(2), fy = m3 * (y3.derivative(2) + s.scene.gravity);
    const double sx = std::sin(s.x[phi2]), sy = std::cos(s.x[phi2]);
    const double tension = fx * sx + fy * sy;
    const double scale = m3 * s.scene.gravity + std::hypot(fx, fy);
    REQUIRE(std::abs(motion.sling_tension(s.x, dxdt) - tension) < 1e-10 * scale);
    REQUIRE(std::abs(fx * sy - fy * sx) < 1e-9 * scale);
  }
}

TEST_CASE(
    "The sling ties the projectile to the arm, and the arm the counterweight to the fulcrum") {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const Sample s = random_sample(random);
    const Motion<double> motion(s.scene, s.design);
    const auto c = motion.counterweight(s.x), tip = motion.arm_tip(s.x), p = motion.projectile(s.x);
    REQUIRE(std::hypot(c.x, c.y) == Approx(s.design.r1).epsilon(1e-14));
    REQUIRE(std::hypot(tip.x, tip.y) == Approx(s.design.r2).epsilon(1e-14));
    REQUIRE(std::hypot(p.x - tip.x, p.y - tip.y) == Approx(s.design.r3).epsilon(1e-13));
    REQUIRE(c.x * tip.y == Approx(c.y * tip.x).margin(1e-14));
  }
}

TEST_CASE("A swing starts at rest with the counterweight at its height") {
  for (const double h : {1.0, 1.4, 1.5, 1.7, 2.0}) {
    Scene scene;
    scene.release_height = h;
    scene.sling_angle = 0.25;
    const Motion<double> motion(scene, {0.51, 0.58, 0.91});
    const State<double> x = start<double>(scene, {0.51, 0.58, 0.91});
    REQUIRE(motion.counterweight(x).y == Approx(h - scene.fulcrum_height).margin(1e-15));
    REQUIRE(motion.counterweight(x).x >= 0);
    REQUIRE(x[phi2] == 0.25);
    REQUIRE(motion.kinetic_energy(x) == 0);
  }
}

TEST_CASE("A counterweight that starts at its lowest point, but for rounding, starts at pi") {
  Scene scene;
  scene.release_height = 1.4;  // 1.4 - 1.5 is not quite -0.1
  CHECK(start<double>(scene, {0.1, 0.5, 0.9})[phi1] == Approx(3.14159265358979));
}

TEST_CASE("The start keeps its digits beside the upright position") {
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
