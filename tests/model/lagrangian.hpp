#pragma once

#include <array>
#include <boost/math/differentiation/autodiff.hpp>
#include <random>

#include "trebsweep/model/motion.hpp"

namespace trebsweep::test {

/// Positions from the coordinates of a swing for any number type, independent of the program's.
template <class Q>
struct Places {
  Q x1, y1, xt, yt, x3, y3;
};

template <class Q1, class Q2, class L>
auto positions(const Design<double>& d, const Q1& q1, const Q2& q2, const L& l) {
  const auto zero = 0 * (q1 + q2 + l);  // of their common type
  const auto xt = -d.r2 * sin(q1) + zero, yt = -d.r2 * cos(q1) + zero;
  return Places<decltype(xt + zero)>{d.r1 * sin(q1) + zero, d.r1 * cos(q1) + zero, xt, yt,
                                     xt - l * sin(q2),      yt - l * cos(q2)};
}

/// Moment of inertia of the beam about the fulcrum: its mass over its length, integrated.
inline double beam_inertia(const Scene& s, const Design<double>& d) {
  const double per_metre = s.beam_density * s.beam_side * s.beam_side;
  if (s.beam_inertia == BeamInertia::none) return 0;
  const double slender = per_metre * (std::pow(d.r1, 3) + std::pow(d.r2, 3)) / 3;
  if (s.beam_inertia == BeamInertia::slender) return slender;
  return slender + per_metre * (d.r1 + d.r2) * s.beam_side * s.beam_side / 12;
}

/// Kinetic minus potential energy from the velocities of the bodies; the sling's is integrated
/// along it (Simpson's rule is exact). l and vl are the sling's length and its rate.
template <class Q1, class Q2, class L, class V1, class V2, class VL>
auto lagrangian(const Scene& s, const Design<double>& d, const Q1& q1, const Q2& q2, const L& l,
                const V1& v1, const V2& v2, const VL& vl) {
  const auto vx1 = d.r1 * cos(q1) * v1, vy1 = -d.r1 * sin(q1) * v1;
  const auto vxt = -d.r2 * cos(q1) * v1, vyt = d.r2 * sin(q1) * v1;
  const auto vx3 = vxt - l * cos(q2) * v2 - vl * sin(q2);
  const auto vy3 = vyt + l * sin(q2) * v2 - vl * cos(q2);
  const auto squared = [](const auto& x, const auto& y) { return x * x + y * y; };
  const auto sling = squared(vxt, vyt) + squared(vxt + vx3, vyt + vy3) + squared(vx3, vy3);
  const auto kinetic = 0.5 * s.counterweight_mass * squared(vx1, vy1) +
                       0.5 * beam_inertia(s, d) * v1 * v1 +
                       0.5 * s.projectile_mass * squared(vx3, vy3) + s.sling_mass / 12 * sling;
  const auto at = positions(d, q1, q2, l);
  const double per_metre = s.beam_density * s.beam_side * s.beam_side;
  const double beam_moment = per_metre * (d.r1 * d.r1 - d.r2 * d.r2) / 2;  // integral of mass x arm
  const auto potential =
      s.gravity * (s.counterweight_mass * at.y1 + beam_moment * cos(q1) +
                   s.projectile_mass * at.y3 + 0.5 * s.sling_mass * (at.yt + at.y3));
  return kinetic - potential;
}

template <Effects E>
struct Sample {
  Scene scene;
  Design<double> design;
  State<double, E> x;

  double sling_length() const {
    if constexpr (E.elastic)
      return x[length];
    else
      return design.r3;
  }
  double sling_rate() const {
    if constexpr (E.elastic)
      return x[stretching];
    else
      return 0;
  }
  /// Tension of an elastic sling, N.
  double tension() const {
    const double stretch = sling_length() - design.r3;
    if (!E.elastic || stretch <= 0) return 0;
    return std::max(0.0, scene.sling_stiffness * stretch + scene.sling_damping * sling_rate());
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
  if (random() % 2 == 0) scene.sling_mass = uniform(0, 100);
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
  return sample;
}

/// The rates by the program's equations.
template <Effects E>
State<double, E> rates(const Sample<E>& sample) {
  State<double, E> dxdt;
  Motion<double, E>(sample.scene, sample.design)(sample.x, dxdt, 0);
  return dxdt;
}

/// Calls f<E>() for every combination of effects.
template <class F>
void for_all_effects(F f) {
  f.template operator()<Effects{false, false}>();
  f.template operator()<Effects{true, false}>();
  f.template operator()<Effects{false, true}>();
  f.template operator()<Effects{true, true}>();
}

}  // namespace trebsweep::test
