#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "trebsweep/scene.hpp"

namespace trebsweep {

/// Places of a swing's coordinates in its state: the two angles (rad, clockwise; phi1 from the
/// upward vertical to the counterweight's arm, phi2 from the downward vertical to the sling) and
/// their rates.
enum Coordinate : std::size_t { phi1, phi2, w1, w2 };

template <class T>
using State = std::array<T, 4>;

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

/// The equations of motion of one design in a scene, and what follows from a state.
///
/// T is the number type: double, a pack of designs, or a multiprecision type. Equation numbers are
/// the paper's; D stands for phi1 - phi2.
template <class T>
class Motion {
 public:
  Motion(const Scene& scene, const Design<T>& design)
      : r1_(design.r1),
        r2_(design.r2),
        r3_(design.r3),
        g_(scene.gravity),
        m3_(scene.projectile_mass),
        height_(scene.release_height - scene.fulcrum_height),
        sling_angle_(scene.sling_angle) {
    const T m1(scene.counterweight_mass);
    const T side(scene.beam_side);
    const T length = r1_ + r2_;
    const T m2 = T(scene.beam_density) * side * side * length;  // (37) (38)
    const T r = (r2_ - r1_) / T(2);                             // (7)
    beam_moment_ = m1 * r1_ - m2 * r;
    T inertia = m1 * r1_ * r1_;
    if (scene.beam_inertia != BeamInertia::none)
      inertia += m2 * length * length / T(12) + m2 * r * r;  // Izz (18)
    if (scene.beam_inertia == BeamInertia::prism) inertia += m2 * side * side / T(12);
    inertia_ = inertia;
  }

  /// The state at the start: at rest, with the counterweight at its height (39).
  /// Only where start_is_reachable().
  State<T> start() const {
    using std::atan2;
    using std::sqrt;
    // arccos(height / r1), written so that it keeps its digits near the upright, unstable
    // equilibrium.
    const T square = (r1_ - height_) * (r1_ + height_);
    const T angle = atan2(square > T(0) ? T(sqrt(square)) : T(0), height_);
    return {angle, sling_angle_, T(0), T(0)};
  }

  /// The right-hand side: rates of x, with the accelerations of (40) and (36).
  void operator()(const State<T>& x, State<T>& dxdt, const T& /*t*/) const {
    const Trig a = trig(x);
    const T w1w1 = x[w1] * x[w1];
    const T w2w2 = x[w2] * x[w2];
    const T pull = g_ * a.sin2 * a.cosD - r3_ * w2w2 * a.sinD - r2_ * w1w1 * a.cosD * a.sinD;
    const T torque = g_ * a.sin1 * (beam_moment_ - m3_ * r2_) + m3_ * r2_ * pull;
    const T acceleration1 = torque / (inertia_ + m3_ * r2_ * r2_ * a.sinD * a.sinD);
    dxdt[phi1] = x[w1];
    dxdt[phi2] = x[w2];
    dxdt[w1] = acceleration1;
    dxdt[w2] = (r2_ * (w1w1 * a.sinD - acceleration1 * a.cosD) - g_ * a.sin2) / r3_;
  }

  /// Kinetic energy of counterweight, beam and projectile, J: (14) + (15) + (20).
  T kinetic_energy(const State<T>& x) const {
    return (inertia_ * x[w1] * x[w1] + m3_ * speed_squared(x)) / T(2);
  }

  /// Potential energy against the fulcrum's height, J: (23) + (24) + (25).
  T potential_energy(const State<T>& x) const {
    using std::cos;
    return g_ * (beam_moment_ * cos(x[phi1]) - m3_ * (r2_ * cos(x[phi1]) + r3_ * cos(x[phi2])));
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
    const Trig a = trig(x);
    const T arm_tip = r2_ * (dxdt[w1] * a.sinD + x[w1] * x[w1] * a.cosD);
    return m3_ * (g_ * cos(x[phi2]) + arm_tip + r3_ * x[w2] * x[w2]);
  }

  /// (1) (2)
  Point<T> counterweight(const State<T>& x) const {
    using std::cos;
    using std::sin;
    return {r1_ * sin(x[phi1]), r1_ * cos(x[phi1])};
  }

  /// The throwing arm's end, where the sling is tied.
  Point<T> arm_tip(const State<T>& x) const {
    using std::cos;
    using std::sin;
    return {-r2_ * sin(x[phi1]), -r2_ * cos(x[phi1])};
  }

  /// (10) (11)
  Point<T> projectile(const State<T>& x) const {
    using std::cos;
    using std::sin;
    const Point<T> tip = arm_tip(x);
    return {tip.x - r3_ * sin(x[phi2]), tip.y - r3_ * cos(x[phi2])};
  }

 private:
  struct Trig {
    T sin1, sin2, sinD, cosD;
  };

  static Trig trig(const State<T>& x) {
    using std::cos;
    using std::sin;
    // D's sine and cosine from those of phi1 and phi2: two evaluations instead of three.
    const T sin1 = sin(x[phi1]), cos1 = cos(x[phi1]);
    const T sin2 = sin(x[phi2]), cos2 = cos(x[phi2]);
    return {sin1, sin2, sin1 * cos2 - cos1 * sin2, cos1 * cos2 + sin1 * sin2};
  }

  // (46), as a sum of squares so that rounding cannot make it negative.
  T speed_squared(const State<T>& x) const {
    using std::cos;
    using std::sin;
    const T D = x[phi1] - x[phi2];
    const T along = r2_ * x[w1] * cos(D) + r3_ * x[w2];
    const T across = r2_ * x[w1] * sin(D);
    return along * along + across * across;
  }

  T r1_, r2_, r3_;
  T g_, m3_;
  T height_;       // h - h0
  T sling_angle_;  // phi2(0)
  T beam_moment_;  // m1 r1 - m2 r
  T inertia_;      // m1 r1^2 + Izz
};

}  // namespace trebsweep
