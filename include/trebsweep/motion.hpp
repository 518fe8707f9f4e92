#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "trebsweep/scene.hpp"
#include "trebsweep/sin_cos.hpp"

namespace trebsweep {

/// Places of a swing's coordinates in its state: the two angles (rad, clockwise; phi1 from the
/// upward vertical to the counterweight's arm, phi2 from the downward vertical to the sling) and
/// their rates.
enum Coordinate : std::size_t { phi1, phi2, w1, w2 };

template <class T>
using State = std::array<T, 4>;

/// Sines and cosines of a state's angles.
enum Direction : std::size_t { sin1, cos1, sin2, cos2 };

template <class T>
using Directions = std::array<T, 4>;

template <class T>
Directions<T> directions(const State<T>& x) {
  const auto a = sin_cos(x[phi1]), b = sin_cos(x[phi2]);
  return {a.sin, a.cos, b.sin, b.cos};
}

/// A place in the plane of the swing, in metres; the fulcrum is the origin, y points up.
template <class T>
struct Point {
  T x, y;
};

/// Whether the counterweight's arm can reach the height it starts from: r1 >= |h - h0| (39).
inline bool start_is_reachable(const Scene& scene, double r1) {
  // A few ulps of slack: h - h0 is rounded, and an arm of just that length is meant to start
  // upright.
  return r1 * (1 + 1e-12) >= std::abs(scene.release_height - scene.fulcrum_height);
}

/// The state at the start: at rest, with the counterweight at its height (39).
/// Only where start_is_reachable().
template <class T>
State<T> start(const Scene& scene, const Design<T>& design) {
  using std::atan2;
  using std::sqrt;
  const T height = scene.release_height - scene.fulcrum_height;
  // arccos(height / r1), written so that it keeps its digits near the upright, unstable
  // equilibrium.
  const T square = T(design.r1 - height) * T(design.r1 + height);
  const T angle = atan2(T(sqrt(select(square > T(0), square, T(0)))), height);
  return {angle, T(scene.sling_angle), T(0), T(0)};
}

/// The equations of motion of one design in a scene, and what follows from a state.
///
/// T is the number type: double, a pack of designs, or a multiprecision type. Equation numbers are
/// the paper's; D stands for phi1 - phi2. The right-hand side has (40) in the form that needs the
/// fewest operations: numerator and denominator divided by m3 r2^2.
template <class T>
class Motion {
 public:
  Motion() = default;
  Motion(const Scene& scene, const Design<T>& design)
      : r1_(design.r1),
        r2_(design.r2),
        r3_(design.r3),
        m3_(scene.projectile_mass),
        g_r2_(scene.gravity / r2_),
        r3_r2_(r3_ / r2_),
        r2_r3_(r2_ / r3_) {
    const T m1(scene.counterweight_mass), side(scene.beam_side);
    const T length = r1_ + r2_;
    const T m2 = T(scene.beam_density) * side * side * length;  // (37) (38)
    const T r = (r2_ - r1_) / T(2);                             // (7)
    T inertia = m1 * r1_ * r1_;
    if (scene.beam_inertia != BeamInertia::none)
      inertia += m2 * length * length / T(12) + m2 * r * r;  // Izz (18)
    if (scene.beam_inertia == BeamInertia::prism) inertia += m2 * side * side / T(12);
    const T m3_r2_r2 = m3_ * r2_ * r2_;
    torque_ = T(scene.gravity) * T(m1 * r1_ - m2 * r - m3_ * r2_) / m3_r2_r2;
    inertia_ = inertia / m3_r2_r2;
  }

  /// The right-hand side: rates of x, with the accelerations of (40) and (36).
  void operator()(const State<T>& x, State<T>& dxdt, const T& /*t*/) const {
    rates(x, directions(x), dxdt);
  }

  /// The same from the angles' sines and cosines; it does not look at the angles.
  void rates(std::span<const T, 4> x, std::span<const T, 4> at, State<T>& dxdt) const {
    // D's sine and cosine from those of phi1 and phi2.
    const T sinD = at[sin1] * at[cos2] - at[cos1] * at[sin2];
    const T cosD = at[cos1] * at[cos2] + at[sin1] * at[sin2];
    const T w1w1 = x[w1] * x[w1];
    const T weight = g_r2_ * at[sin2];
    const T whirl = w1w1 * cosD + r3_r2_ * x[w2] * x[w2];
    const T numerator = torque_ * at[sin1] + T(weight * cosD - sinD * whirl);
    const T acceleration1 = quotient(numerator, T(sinD * sinD + inertia_));
    dxdt[phi1] = x[w1];
    dxdt[phi2] = x[w2];
    dxdt[w1] = acceleration1;
    dxdt[w2] = T(T(w1w1 * sinD - weight) - acceleration1 * cosD) * r2_r3_;
  }

  /// Kinetic energy of counterweight, beam and projectile, J: (14) + (15) + (20).
  T kinetic_energy(const State<T>& x) const {
    return m3_ * (inertia_ * r2_ * r2_ * x[w1] * x[w1] + speed_squared(x)) / T(2);
  }

  /// Potential energy against the fulcrum's height, J: (23) + (24) + (25).
  T potential_energy(const State<T>& x) const {
    using std::cos;
    return m3_ * r2_ * (torque_ * r2_ * cos(x[phi1]) - g_r2_ * r3_ * cos(x[phi2]));
  }

  T energy(const State<T>& x) const { return kinetic_energy(x) + potential_energy(x); }

  /// The projectile's speed, m/s (46).
  T speed(const State<T>& x) const {
    using std::sqrt;
    return sqrt(speed_squared(x));
  }

  /// Force along the sling, N; negative where a rigid sling would have to push. It is the
  /// projectile's equation of motion along the sling, with the positions (10) (11) differentiated
  /// twice.
  T sling_tension(const State<T>& x, const State<T>& dxdt) const {
    using std::cos;
    const auto [sinD, cosD] = sin_cos(T(x[phi1] - x[phi2]));
    const T arm_tip = dxdt[w1] * sinD + x[w1] * x[w1] * cosD;
    return m3_ * (r2_ * (g_r2_ * cos(x[phi2]) + arm_tip) + r3_ * x[w2] * x[w2]);
  }

  /// (1) (2)
  Point<T> counterweight(const State<T>& x) const {
    const auto [sin1, cos1] = sin_cos(x[phi1]);
    return {r1_ * sin1, r1_ * cos1};
  }

  /// The throwing arm's end, where the sling is tied.
  Point<T> arm_tip(const State<T>& x) const {
    const auto [sin1, cos1] = sin_cos(x[phi1]);
    return {-r2_ * sin1, -r2_ * cos1};
  }

  /// (10) (11)
  Point<T> projectile(const State<T>& x) const {
    const auto [sin2, cos2] = sin_cos(x[phi2]);
    const Point<T> tip = arm_tip(x);
    return {tip.x - r3_ * sin2, tip.y - r3_ * cos2};
  }

 private:
  // (46), as a sum of squares so that rounding cannot make it negative.
  T speed_squared(const State<T>& x) const {
    const auto [sinD, cosD] = sin_cos(T(x[phi1] - x[phi2]));
    const T along = r2_ * x[w1] * cosD + r3_ * x[w2];
    const T across = r2_ * x[w1] * sinD;
    return along * along + across * across;
  }

  T r1_, r2_, r3_;
  T m3_;
  T g_r2_, r3_r2_, r2_r3_;
  T torque_;  // of the weights with the arm level, over m3 r2^2: g (m1 r1 - m2 r - m3 r2)/(m3 r2^2)
  T inertia_;  // (m1 r1^2 + Izz)/(m3 r2^2)
};

}  // namespace trebsweep
