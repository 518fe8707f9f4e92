#pragma once

#include <array>
#include <boost/math/differentiation/autodiff.hpp>
#include <random>
#include <utility>

#include "trebsweep/model/motion.hpp"

namespace trebsweep::test {

/// Positions of counterweight, arm's tip and projectile, m.
template <class Q>
struct Places {
  Q x1, y1, xt, yt, x3, y3;
};

/// Positions from the coordinates of a swing for any number type, independent of the program's. The
/// third coordinate q3 is the angle of the hanger if there is one, else the length of the sling.
template <class Q1, class Q2, class Q3>
auto positions(const Scene& s, const Design<double>& d, const Q1& q1, const Q2& q2, const Q3& q3) {
  const double r4 = s.counterweight_hanger;
  const auto l = r4 > 0 ? d.r3 + 0 * q3 : q3;
  const auto zero = 0 * (q1 + q2 + q3);  // of their common type
  const auto xt = -d.r2 * sin(q1) + zero, yt = -d.r2 * cos(q1) + zero;
  return Places<decltype(xt + zero)>{d.r1 * sin(q1) - r4 * sin(q3) + zero,
                                     d.r1 * cos(q1) - r4 * cos(q3) + zero,
                                     xt,
                                     yt,
                                     xt - l * sin(q2),
                                     yt - l * cos(q2)};
}

/// Mass of the beam (kg), its first moment towards the counterweight (kg m) and its moment of
/// inertia (kg m^2) about the fulcrum.
struct Beam {
  double mass, moment, inertia;
};

/// The measured beam, or the mass of the computed one integrated over its length.
inline Beam beam(const Scene& s, const Design<double>& d) {
  if (s.beam_mass) return {*s.beam_mass, -*s.beam_mass * *s.beam_centre, *s.beam_moment};
  const double depth = s.beam_depth.value_or(s.beam_side);
  const double area = s.beam_width.value_or(s.beam_side) * depth, per_metre = s.beam_density * area;
  const double mass = per_metre * (d.r1 + d.r2);
  const double moment = per_metre * (d.r1 * d.r1 - d.r2 * d.r2) / 2;
  double inertia = per_metre * (std::pow(d.r1, 3) + std::pow(d.r2, 3)) / 3;
  if (s.beam_inertia == BeamInertia::none) inertia = 0;
  if (s.beam_inertia == BeamInertia::prism) inertia += mass * depth * depth / 12;
  return {mass, moment, inertia};
}

/// The scene with a beam that is computed, not measured.
inline Scene with_computed_beam(Scene s) {
  s.beam_mass = s.beam_centre = s.beam_moment = std::nullopt;
  return s;
}

/// Kinetic minus potential energy from the velocities of the bodies; the sling's is integrated
/// along it (Simpson's rule is exact). v1, v2 and v3 are the rates of q1, q2 and q3.
template <class Q1, class Q2, class Q3, class V1, class V2, class V3>
auto lagrangian(const Scene& s, const Design<double>& d, const Q1& q1, const Q2& q2, const Q3& q3,
                const V1& v1, const V2& v2, const V3& v3) {
  const double r4 = s.counterweight_hanger;
  const auto l = r4 > 0 ? d.r3 + 0 * q3 : q3;
  const auto vl = r4 > 0 ? 0 * v3 : v3;
  const auto vx1 = d.r1 * cos(q1) * v1 - r4 * cos(q3) * v3;
  const auto vy1 = -d.r1 * sin(q1) * v1 + r4 * sin(q3) * v3;
  const auto vxt = -d.r2 * cos(q1) * v1, vyt = d.r2 * sin(q1) * v1;
  const auto vx3 = vxt - l * cos(q2) * v2 - vl * sin(q2);
  const auto vy3 = vyt + l * sin(q2) * v2 - vl * cos(q2);
  const auto squared = [](const auto& x, const auto& y) { return x * x + y * y; };
  const auto sling = squared(vxt, vyt) + squared(vxt + vx3, vyt + vy3) + squared(vx3, vy3);
  const Beam b = beam(s, d);
  const double with_arm = b.inertia + (r4 > 0 ? 0 : s.counterweight_inertia);
  const double with_hanger = r4 > 0 ? s.counterweight_inertia : 0;
  const auto kinetic = 0.5 * s.counterweight_mass * squared(vx1, vy1) + 0.5 * with_arm * v1 * v1 +
                       0.5 * with_hanger * v3 * v3 + 0.5 * s.projectile_mass * squared(vx3, vy3) +
                       s.sling_mass / 12 * sling;
  const auto at = positions(s, d, q1, q2, q3);
  const auto potential =
      s.gravity * (s.counterweight_mass * at.y1 + b.moment * cos(q1) + s.projectile_mass * at.y3 +
                   0.5 * s.sling_mass * (at.yt + at.y3));
  return kinetic - potential;
}

template <Effects E>
struct Sample {
  Scene scene;
  Design<double> design;
  State<double, E> x;

  /// The third coordinate of positions() and lagrangian(), and its rate.
  double q3() const {
    if constexpr (coordinates<E> == 6)
      return x[4];
    else
      return design.r3;
  }
  double v3() const {
    if constexpr (coordinates<E> == 6)
      return x[5];
    else
      return 0;
  }
  /// Stretch of an elastic sling, m.
  double stretch() const {
    if constexpr (E.elastic)
      return std::max(0.0, x[length] - design.r3);
    else
      return 0;
  }
  /// Tension of an elastic sling, N.
  double tension() const {
    if (stretch() == 0) return 0;
    return std::max(0.0, scene.sling_stiffness * stretch() + scene.sling_damping * v3());
  }
};

/// A random scene with those effects, a design and a state.
template <Effects E>
Sample<E> random_sample(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Sample<E> sample;
  Scene& scene = sample.scene;
  scene.gravity = uniform(1, 20);
  scene.counterweight_mass = uniform(100, 10000);
  scene.projectile_mass = uniform(1, 1000);
  scene.beam_density = uniform(0, 8000);
  scene.beam_side = uniform(0.01, 0.3);
  scene.beam_inertia = static_cast<BeamInertia>(random() % 3);
  if (random() % 2 == 0) {
    scene.beam_width = uniform(0.01, 0.3);
    scene.beam_depth = uniform(0.01, 0.3);
  }
  if (random() % 2 == 0) scene.counterweight_inertia = uniform(0, 1000);
  if (random() % 2 == 0) scene.sling_mass = uniform(0, 100);
  if (random() % 2 == 0) {
    scene.beam_mass = uniform(1, 500);
    scene.beam_centre = uniform(-1, 1);
    scene.beam_moment = uniform(1, 500);
  }
  sample.design = {uniform(0.2, 2), uniform(0.2, 2), uniform(0.2, 2)};
  sample.x = {uniform(-6, 6), uniform(-6, 6), uniform(-10, 10), uniform(-20, 20)};
  if constexpr (E.pivot) {
    if (random() % 2 == 0) scene.pivot_viscosity = uniform(0, 1000);
    if (random() % 2 == 0) scene.pivot_friction = uniform(0, 1000);
  }
  if constexpr (E.elastic) {
    scene.sling_stiffness = uniform(1e3, 1e6);
    if (random() % 2 == 0) scene.sling_damping = uniform(0, 1e4);
    sample.x[length] = sample.design.r3 * uniform(0.8, 1.4);
    sample.x[stretching] = uniform(-5, 5);
  }
  if constexpr (E.hanger) {
    scene.counterweight_hanger = uniform(0.1, 2);
    sample.x[phi3] = uniform(-6, 6);
    sample.x[w3] = uniform(-10, 10);
  }
  if constexpr (E.trough) {
    scene.trough = true;
    scene.trough_height = uniform(-1, 1);
  }
  return sample;
}

/// The motion of a sample, whose projectile slides if there is a trough.
template <Effects E>
Motion<double, E> motion(const Sample<E>& sample) {
  return {sample.scene, sample.design};
}

/// The rates by the program's equations.
template <Effects E>
State<double, E> rates(const Sample<E>& sample) {
  State<double, E> dxdt;
  motion(sample)(sample.x, dxdt, 0);
  return dxdt;
}

/// The trough's force on the projectile by the program's equations, N.
template <Effects E>
double normal_force(const Sample<E>& sample) {
  return motion(sample).normal_force(sample.x, directions<E>(sample.x));
}

/// Calls f<E>() for every combination of effects.
template <class F>
void for_all_effects(F f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f.template operator()<all_effects[I]>(), ...);
  }
  (std::make_index_sequence<all_effects.size()>());
}

}  // namespace trebsweep::test
