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
template <class T, Effects E = Effects{}>
class Motion {
 public:
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
    rates(x, directions(x), dxdt);
  }

  /// The same from the sines and cosines of the angles; the angles in x are not used. X is T, or a
  /// dual number over T.
  template <class X = T>
  void rates(std::span<const std::type_identity_t<X>, coordinates<E>> x,
             std::span<const std::type_identity_t<X>, 4> at,
             std::span<std::type_identity_t<X>, coordinates<E>> dxdt) const {
    // Sine and cosine of D by the addition theorems.
    const X sinD = at[sin1] * at[cos2] - at[cos1] * at[sin2];
    const X cosD = at[cos1] * at[cos2] + at[sin1] * at[sin2];
    const X weight = g_r2_ * at[sin2];
    dxdt[phi1] = x[w1];
    dxdt[phi2] = x[w2];
    if constexpr (E.elastic) {
      const X per_length = X(1) / x[length];
      const X w1w1 = x[w1] * x[w1];
      const X tension = elastic_tension(X(x[length] - sling_.r3), x[stretching],
                                        X(sling_.stiffness), X(sling_.damping));
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
    } else {
      // The division depends on the angles only, which a stepper knows before the rates of a stage:
      // its latency is hidden.
      const X per_inertia = X(1) / X(sinD * sinD + sling_.inertia);
      const X gravity = torque_ * at[sin1] + weight * cosD;
      const X w1w1 = x[w1] * x[w1];
      const X whirl = w1w1 * cosD + X(sling_.r3_r2 * x[w2]) * x[w2];
      const X acceleration1 = with_friction(X(gravity - sinD * whirl), x[w1]) * per_inertia;
      dxdt[w1] = acceleration1;
      dxdt[w2] = X(X(w1w1 * sinD - weight) - acceleration1 * cosD) * sling_.r2_r3;
    }
  }

 private:
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
  struct None {};

  T g_r2_;
  // Rigid: g (m1 r1 - m2 r - M r2) / (M1^2/M2 r2^2); elastic: g (m1 r1 - m2 r - m r2) / (I0 + m
  // r2^2).
  T torque_;
  std::conditional_t<E.elastic, Elastic, Rigid> sling_;
  [[no_unique_address]] std::conditional_t<E.pivot, Friction, None> pivot_;
};

}  // namespace trebsweep
