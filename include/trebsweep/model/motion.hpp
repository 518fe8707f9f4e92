#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

#include "trebsweep/model/mechanism.hpp"

namespace trebsweep {

/// The equations of motion of one design in a scene.
///
/// T is the number type: double, a pack of designs, or a multiprecision type. E selects the
/// effects. Equation numbers are the paper's; D stands for phi1 - phi2. README.md has the
/// derivation.
///
/// Lagrange's equations, with I0 w1^2/2 for counterweight and beam (14) (15), the masses M, M1, M2
/// of SlingMasses, and the sling's length l, follow from
///   kinetic energy     (I0 w1^2 + M r2^2 w1^2 + M2 (l^2 w2^2 + l'^2))/2
///                      + M1 r2 w1 (l w2 cos D - l' sin D),
///   potential energy   g [(m1 r1 - m2 r - M r2) cos phi1 - M1 l cos phi2];
/// the sling's tension S, and the pivot's friction torque Q = -c w1 - F sign w1:
///   (I0 + M r2^2) w1' + M1 r2 [l w2' cos D - l'' sin D + 2 l' w2 cos D + l w2^2 sin D]
///                                                     = g (m1 r1 - m2 r - M r2) sin phi1 + Q,
///   M1 r2 (w1' cos D - w1^2 sin D) + M2 (l w2' + 2 l' w2) = -g M1 sin phi2,
///   M2 (l'' - l w2^2) - M1 r2 (w1' sin D + w1^2 cos D) = g M1 cos phi2 - S.
/// Eliminating l'' and w2' by the last two, the first becomes
///   (I0 + m r2^2) w1' = g (m1 r1 - m2 r - m r2) sin phi1 - M1/M2 r2 S sin D + Q, m = M - M1^2/M2.
/// For a rigid sling, l = r3, and the first two give (40) and (36). Both sides of (40) are divided
/// by M1^2/M2 r2^2 here, the form with the fewest operations. The sling's mass only changes
/// constants.
///
/// A counterweight on a hanger of length r4 is another pendulum on the arm; E stands for phi1 -
/// phi3:
///   r4 w3' = r1 (w1' cos E - w1^2 sin E) - g sin phi3,
/// and its tension adds m1 r1^2 sin^2 E to the factor of w1', and
/// m1 r1 sin E (g cos phi3 - r1 w1^2 cos E + r4 w3^2) to the right-hand side, in place of m1 r1^2
/// and g m1 r1 sin phi1. With a moment of inertia of its own, it moves like the two point masses of
/// CounterweightMasses.
///
/// In the trough, the normal force N is the multiplier of the constraint y3'' = 0, on which both
/// accelerations depend linearly.
template <class T, Effects E = Effects{}>
class Motion {
 public:
  template <class X>
  using StateOf = std::span<const std::type_identity_t<X>, coordinates<E>>;
  template <class X>
  using DirectionsOf = std::span<const std::type_identity_t<X>, direction_count<E>>;

  Motion() = default;
  Motion(const Scene& scene, const Design<T>& design) : g_r2_(scene.gravity / design.r2) {
    const SlingMasses m(scene);
    const Mechanism<T, E> mechanism(scene, design);
    const auto& [r1, r3, r2] = design;
    const double ratio = m.coupling / m.swinging;  // M1/M2
    // M - M1^2/M2, exactly zero for a massless sling.
    const double tip =
        scene.sling_mass * (4 * scene.projectile_mass + scene.sling_mass) / (12 * m.swinging);
    const T inertia = mechanism.inertia() + T(tip) * r2 * r2;
    const T scale = E.elastic ? inertia : T(T(m.coupling * ratio) * r2 * r2);
    torque_ = T(scene.gravity) * T(mechanism.moment() - T(E.elastic ? tip : m.all) * r2) / scale;
    if constexpr (E.elastic) {
      const T arm = T(ratio) * r2;
      sling_ = {r3,
                arm,
                arm / scale,
                T(scene.sling_stiffness),
                T(scene.sling_damping),
                T(1 / m.swinging)};
    } else {
      sling_ = {inertia / scale, r3 / T(T(ratio) * r2), T(ratio) * r2 / r3};
    }
    if constexpr (E.hanger) {
      const CounterweightMasses masses = mechanism.counterweight_masses();
      const T m1(masses.swinging), r4(masses.length);
      hanger_ = {m1 * r1 * r1 / scale, T(scene.gravity) / r1, r4 / r1, r1 / r4};
    }
    if constexpr (E.trough)
      trough_ = {T(1), r2, r3, T(1) / r2, T(1) / T(T(ratio) * r2), T(m.coupling), T(scene.gravity)};
    if constexpr (E.pivot)
      pivot_ = {T(scene.pivot_viscosity) / scale, T(scene.pivot_friction) / scale, T(1e9)};
  }

  /// The same motion with the time in units of h seconds: rates of x are multiplied by h,
  /// accelerations by h^2.
  Motion in_units_of(const T& h) const {
    const T hh = h * h;
    Motion scaled = *this;
    scaled.g_r2_ = g_r2_ * hh;
    scaled.torque_ = torque_ * hh;
    if constexpr (E.hanger) scaled.hanger_.g_r1 = hanger_.g_r1 * hh;
    if constexpr (E.trough) scaled.trough_.g = trough_.g * hh;
    if constexpr (E.elastic) {
      scaled.sling_.stiffness = sling_.stiffness * hh;
      scaled.sling_.damping = sling_.damping * h;
    }
    if constexpr (E.pivot)
      scaled.pivot_ = {T(pivot_.viscosity * h), T(pivot_.friction * hh), T(pivot_.start * h)};
    return scaled;
  }

  /// The right-hand side: rates of x, with the accelerations of (40) and (36).
  void operator()(const State<T, E>& x, State<T, E>& dxdt, const T& /*t*/) const {
    rates(x, directions<E>(x), dxdt);
  }

  /// The same from the sines and cosines of the angles; the angles in x are not used. X is T, or a
  /// dual number over T.
  template <class X = T>
  void rates(StateOf<X> x, DirectionsOf<X> at,
             std::span<std::type_identity_t<X>, coordinates<E>> dxdt) const {
    dxdt[phi1] = x[w1];
    dxdt[phi2] = x[w2];
    if constexpr (E.elastic) {
      elastic_rates<X>(x, at, dxdt);
    } else {
      const auto accelerations = rigid_accelerations<X>(x, at);
      dxdt[w1] = accelerations.first;
      dxdt[w2] = accelerations.second;
      if constexpr (E.hanger) {
        dxdt[phi3] = x[w3];
        dxdt[w3] = accelerations.third;
      }
    }
  }

  /// The force of the trough on the projectile, N (times h^2 for a motion in units of h); negative
  /// where only a pull would keep the projectile in the trough, and zero after lift-off.
  T normal_force(StateOf<T> x, DirectionsOf<T> at) const {
    if constexpr (E.trough)
      return trough_.mass * rigid_accelerations<T>(x, at).normal;
    else
      return T(0);
  }

  /// 1 while the projectile slides in the trough, else 0. Starts as 1.
  T sliding() const {
    if constexpr (E.trough)
      return trough_.sliding;
    else
      return T(0);
  }
  void set_sliding(const T& sliding) {
    if constexpr (E.trough) trough_.sliding = sliding;
  }

 private:
  /// w1', w2', w3', and the normal force of the trough divided by M1.
  template <class X>
  struct Accelerations {
    X first, second, third, normal;
  };

  template <class X>
  Accelerations<X> rigid_accelerations(StateOf<X> x, DirectionsOf<X> at) const {
    const auto [sinD, cosD] = difference<X>(at[sin1], at[cos1], at[sin2], at[cos2]);
    Accelerations<X> result{};
    // The division depends on the angles only, which a stepper knows before the rates of a stage:
    // its latency is hidden.
    X inertia = sinD * sinD + sling_.inertia;
    [[maybe_unused]] SinCos<X> e{};
    if constexpr (E.hanger) {
      e = difference<X>(at[sin1], at[cos1], at[sin3], at[cos3]);
      inertia = inertia + hanger_.inertia * X(e.sin * e.sin);
    }
    const X per_inertia = X(1) / inertia;
    // In the trough, the weights are those under N = M1 g, the force on a projectile at rest: dry
    // friction then holds the beam without rounding errors, which it would amplify.
    T g_r2 = g_r2_, arm_torque = torque_;
    if constexpr (E.trough) {
      g_r2 = select(trough_.sliding > T(0), T(0), g_r2_);
      arm_torque =
          select(trough_.sliding > T(0), T(torque_ + trough_.g * trough_.per_arm), torque_);
    }
    const X weight = g_r2 * at[sin2];
    const X gravity = arm_torque * at[sin1] + weight * cosD;
    const X w1w1 = x[w1] * x[w1];
    const X whirl = w1w1 * cosD + X(sling_.r3_r2 * x[w2]) * x[w2];
    X torque = gravity - sinD * whirl;
    if constexpr (E.hanger) {
      const X pull = X(hanger_.g_r1 * at[cos3] - w1w1 * e.cos) + X(hanger_.r4_r1 * x[w3]) * x[w3];
      torque = torque + hanger_.inertia * X(e.sin * pull);
    }
    result.first = with_friction(torque, x[w1]) * per_inertia;
    result.second = X(X(w1w1 * sinD - weight) - result.first * cosD) * sling_.r2_r3;
    if constexpr (E.trough) {
      // The accelerations per N/M1, and what y3'' = 0 adds to N/M1.
      const X lever = trough_.per_r2 * at[sin2];
      const X first = X(trough_.per_arm * at[sin1] - lever * cosD) * per_inertia;
      const X second = X(lever - first * cosD) * sling_.r2_r3;
      const X rise1 = trough_.r2 * at[sin1], rise2 = trough_.r3 * at[sin2];
      const X falling = X(trough_.r2 * at[cos1]) * w1w1 + X(trough_.r3 * at[cos2]) * x[w2] * x[w2];
      const X rise = X(rise1 * result.first + rise2 * result.second) + falling;
      const X constrained = X(0) - rise / X(rise1 * first + rise2 * second);
      const X added = select(trough_.sliding > T(0), constrained, X(0));
      result.first = result.first + added * first;
      result.second = result.second + added * second;
      result.normal = select(trough_.sliding > T(0), X(trough_.g + added), X(0));
    }
    if constexpr (E.hanger)
      result.third =
          X(X(result.first * e.cos - w1w1 * e.sin) - hanger_.g_r1 * at[sin3]) * hanger_.r1_r4;
    return result;
  }

  /// Sets the accelerations and the rates of the sling's length.
  template <class X>
  void elastic_rates(StateOf<X> x, DirectionsOf<X> at, std::span<X, coordinates<E>> dxdt) const {
    const auto [sinD, cosD] = difference<X>(at[sin1], at[cos1], at[sin2], at[cos2]);
    const X weight = g_r2_ * at[sin2];
    const X per_length = X(1) / x[length];
    const X w1w1 = x[w1] * x[w1];
    const X tension = elastic_tension(X(x[length] - sling_.r3), x[stretching], X(sling_.stiffness),
                                      X(sling_.damping));
    const X torque = torque_ * at[sin1] - sling_.arm_inertia * tension * sinD;
    const X acceleration1 = with_friction(torque, x[w1]);
    const X across = X(w1w1 * sinD - weight) - acceleration1 * cosD;
    const X along = g_r2_ * at[cos2] + X(w1w1 * cosD + acceleration1 * sinD);
    const X twice = X(2) * x[stretching];
    dxdt[w1] = acceleration1;
    dxdt[w2] = X(sling_.arm * across - twice * x[w2]) * per_length;
    dxdt[length] = x[stretching];
    dxdt[stretching] =
        sling_.arm * along + X(x[length] * x[w2] * x[w2] - tension * sling_.per_mass);
  }

  /// Sine and cosine of the difference of two angles, by the addition theorems.
  template <class X>
  static SinCos<X> difference(const X& sin_a, const X& cos_a, const X& sin_b, const X& cos_b) {
    return {X(sin_a * cos_b - cos_a * sin_b), X(cos_a * cos_b + sin_a * sin_b)};
  }

  /// A torque reduced by the pivot's friction. Dry friction opposes the rotation and, at rest, the
  /// torque itself up to its magnitude.
  template <class X>
  X with_friction(const X& torque, const X& rate) const {
    if constexpr (E.pivot) {
      const X viscous = torque - pivot_.viscosity * rate;
      // The sign of the rate decides, unless the rate is below what the torque causes in 1 ns:
      // fehlberg78 has stages that return to a start at rest up to rounding errors.
      const X driving = X(pivot_.start) * rate + viscous;
      const X most(pivot_.friction), least(-pivot_.friction);
      const X dry = select(driving < most, select(driving > least, driving, least), most);
      return viscous - dry;
    } else {
      return torque;
    }
  }

  struct Rigid {
    T inertia;  // (I0 + (M - M1^2/M2) r2^2) / (M1^2/M2 r2^2)
    T r3_r2, r2_r3;
  };
  struct Elastic {
    T r3;
    T arm;          // M1/M2 r2
    T arm_inertia;  // M1/M2 r2 / (I0 + (M - M1^2/M2) r2^2)
    T stiffness, damping;
    T per_mass;  // 1/M2
  };
  struct Friction {
    T viscosity, friction;
    T start;  // 1/s
  };
  struct Hanger {
    T inertia;  // m1 r1^2 / (M1^2/M2 r2^2)
    T g_r1, r4_r1, r1_r4;
  };
  struct Trough {
    T sliding;
    T r2, r3, per_r2;
    T per_arm;  // 1/(M1/M2 r2)
    T mass;     // M1
    T g;
  };
  template <class Effect>
  struct Without {};

  template <bool with, class Effect>
  using Part = std::conditional_t<with, Effect, Without<Effect>>;

  T g_r2_;
  // Rigid: g (m1 r1 - m2 r - M r2) / (M1^2/M2 r2^2); elastic: g (m1 r1 - m2 r - m r2) / (I0 + m
  // r2^2).
  T torque_;
  std::conditional_t<E.elastic, Elastic, Rigid> sling_;
  [[no_unique_address]] Part<E.pivot, Friction> pivot_;
  [[no_unique_address]] Part<E.hanger, Hanger> hanger_;
  [[no_unique_address]] Part<E.trough, Trough> trough_;
};

}  // namespace trebsweep
