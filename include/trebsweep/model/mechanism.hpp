#pragma once

#include <cmath>
#include <limits>

#include "trebsweep/model/state.hpp"

namespace trebsweep {

/// A position, velocity or force in the plane of the swing (SI units). The origin is the fulcrum; y
/// points up.
template <class T>
struct Vector {
  T x, y;

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y}; }
  friend Vector operator*(const T& s, const Vector& a) { return {s * a.x, s * a.y}; }
  friend T dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
};

/// Effective masses of projectile and sling, kg. The velocity of the sling is linear along its
/// length, so that its whole mass moves with the arm's tip (M), half of it couples the motions of
/// tip and projectile (M1), and a third swings about the tip (M2).
struct SlingMasses {
  explicit SlingMasses(const Scene& scene)
      : all(scene.projectile_mass + scene.sling_mass),
        coupling(scene.projectile_mass + scene.sling_mass / 2),
        swinging(scene.projectile_mass + scene.sling_mass / 3) {}
  double all, coupling, swinging;  // M, M1, M2
};

/// The counterweight as point masses with the same mass, centre and moment of inertia: on a hanger,
/// one at the hinge and one at the centre of oscillation; else one at the end of the arm, where
/// counterweight_inertia is added to the beam's.
struct CounterweightMasses {
  CounterweightMasses(const Scene& scene, bool has_hanger) {
    const double m1 = scene.counterweight_mass, r4 = scene.counterweight_hanger;
    const double point = m1 * r4 * r4;
    const double share = has_hanger ? point / (point + scene.counterweight_inertia) : 0;
    fixed = m1 * (1 - share);
    swinging = m1 * share;
    if (has_hanger) length = r4 / share;
  }
  double fixed;       // kg: at the end of the arm
  double swinging;    // kg: on the hanger
  double length = 0;  // m: from the hinge to the swinging mass
};

/// Tension of an elastic sling, N, for a stretch (m) and its rate (m/s); never negative.
template <class T>
T elastic_tension(const T& stretch, const T& rate, const T& stiffness, const T& damping) {
  const T force = stiffness * stretch + damping * rate;
  return select((stretch > T(0)) & (force > T(0)), force, T(0));
}

/// The loads of sling, hanger, axle and beam, and heights above the ground, at one time.
template <class T>
struct Loads {
  T projectile_tension;  ///< N: of the sling at the projectile; negative where a rigid sling would
                         ///< be under compression
  T tip_tension;         ///< N: of the sling at the arm's tip
  T axle;                ///< N: force between axle and beam
  T beam_stress;     ///< Pa: bending stress at the fulcrum, at the surface of the throwing arm; its
                     ///< sign is that of the bending moment; NaN for a measured beam
  T hanger_tension;  ///< N: of the hanger; negative under compression; zero without one
  T tip_height;      ///< m: of the throwing arm's tip
  T counterweight_height;  ///< m
  T projectile_height;     ///< m
};

/// Positions, velocities, energies and loads of one design in a scene, as functions of the state;
/// the equations of motion are in Motion. Equation numbers are the paper's; D stands for phi1 -
/// phi2.
template <class T, Effects E = Effects{}>
class Mechanism {
 public:
  using X = State<T, E>;
  using At = Directions<T, E>;  ///< of the angles of a state, for callers that know them

  Mechanism(const Scene& scene, const Design<T>& design) : scene_(scene), design_(design) {}

  /// m2, kg: measured, or (37) (38).
  T beam_mass() const {
    if (scene_.beam_mass) return T(*scene_.beam_mass);
    const auto [width, depth] = beam_section(scene_);
    return T(scene_.beam_density) * T(width) * T(depth) * T(design_.r1 + design_.r2);
  }

  /// Distance of the beam's centre of mass from the fulcrum, m, positive towards the sling:
  /// measured, or (7).
  T beam_centre() const {
    if (scene_.beam_centre) return T(*scene_.beam_centre);
    return (design_.r2 - design_.r1) / T(2);
  }

  /// Moment of inertia of beam and fixed counterweight about the fulcrum, kg m^2: m1 r1^2 + Izz
  /// (18), plus counterweight_inertia.
  T inertia() const {
    const auto& [r1, r3, r2] = design_;
    const T m1(counterweight_masses().fixed), depth(beam_section(scene_).depth);
    const T m2 = beam_mass(), r = beam_centre(), beam_length = r1 + r2;
    T sum = m1 * r1 * r1;
    if constexpr (!E.hanger) sum += T(scene_.counterweight_inertia);
    if (scene_.beam_moment) return sum + T(*scene_.beam_moment);
    if (scene_.beam_inertia != BeamInertia::none)
      sum += m2 * beam_length * beam_length / T(12) + m2 * r * r;
    if (scene_.beam_inertia == BeamInertia::prism) sum += m2 * depth * depth / T(12);
    return sum;
  }

  /// First moment of mass of beam and fixed counterweight about the fulcrum, kg m: m1 r1 - m2 r.
  T moment() const {
    const T m1(counterweight_masses().fixed);
    return m1 * design_.r1 - beam_mass() * beam_centre();
  }

  /// m: r3, or the current length of an elastic sling.
  T sling_length(const X& x) const {
    if constexpr (E.elastic)
      return x[length];
    else
      return design_.r3;
  }

  /// Tension of an elastic sling, N.
  T sling_tension(const X& x) const {
    return elastic_tension(T(x[length] - design_.r3), x[stretching], T(scene_.sling_stiffness),
                           T(scene_.sling_damping));
  }

  /// Kinetic energy of counterweight, beam, sling and projectile, J: (14) + (15) + (20), plus
  /// ms (vt^2 + vt.vp + vp^2)/6 for a sling between a tip of velocity vt and a projectile of vp.
  T kinetic_energy(const X& x) const {
    const SlingMasses m(scene_);
    const auto [sinD, cosD] = sin_cos(T(x[phi1] - x[phi2]));
    const T tip = design_.r2 * x[w1], swing = sling_length(x) * x[w2];
    T along_tip = swing * cosD, swing_squared = swing * swing;
    if constexpr (E.elastic) {
      along_tip = along_tip - x[stretching] * sinD;
      swing_squared = swing_squared + x[stretching] * x[stretching];
    }
    T twice = T(inertia() * x[w1] * x[w1] + T(m.all) * tip * tip +
                T(2 * m.coupling) * tip * along_tip + T(m.swinging) * swing_squared);
    if constexpr (E.hanger) {
      const At at = directions<E>(x);
      const Vector<T> v = T(design_.r1 * x[w1]) * turned(arm(at)) +
                          T(T(-counterweight_masses().length) * x[w3]) * turned(hanger(at));
      twice += T(counterweight_masses().swinging) * dot(v, v);
    }
    return twice / T(2);
  }

  /// Gravitational potential energy relative to the fulcrum's height, J: (23) + (24) + (25).
  T potential_energy(const X& x) const {
    const SlingMasses m(scene_);
    const T arms = moment() - T(m.all) * design_.r2;
    T moments =
        T(arms * sin_cos(x[phi1]).cos - T(m.coupling) * sling_length(x) * sin_cos(x[phi2]).cos);
    if constexpr (E.hanger) {
      const At at = directions<E>(x);
      moments += T(counterweight_masses().swinging) *
                 T(design_.r1 * arm(at).y - T(counterweight_masses().length) * hanger(at).y);
    }
    return T(scene_.gravity) * moments;
  }

  /// Kinetic, potential and elastic energy, J.
  T energy(const X& x) const {
    const T sum = kinetic_energy(x) + potential_energy(x);
    if constexpr (E.elastic) {
      const T stretch = x[length] - design_.r3;
      return sum +
             select(stretch > T(0), T(T(0.5 * scene_.sling_stiffness) * stretch * stretch), T(0));
    }
    return sum;
  }

  /// Power dissipated by friction at the pivot and damping of the sling, W.
  T dissipation(const X& x) const {
    using std::abs;
    T sum = T(scene_.pivot_viscosity) * x[w1] * x[w1] + T(scene_.pivot_friction) * abs(x[w1]);
    if constexpr (E.elastic) {
      const T stretch = x[length] - design_.r3;
      const T spring = T(scene_.sling_stiffness) * select(stretch > T(0), stretch, T(0));
      sum += T(sling_tension(x) - spring) * x[stretching];
    }
    return sum;
  }

  /// Speed of the projectile, m/s (46), as a sum of squares, which rounding cannot make negative.
  T speed(const X& x) const {
    using std::sqrt;
    const auto [sinD, cosD] = sin_cos(T(x[phi1] - x[phi2]));
    const T across = design_.r2 * x[w1] * cosD + sling_length(x) * x[w2];
    T along = design_.r2 * x[w1] * sinD;
    if constexpr (E.elastic) along = along - x[stretching];
    return sqrt(T(across * across + along * along));
  }

  /// (1) (2); below the arm's end with a hanger.
  Vector<T> counterweight(const X& x) const {
    const At at = directions<E>(x);
    const Vector<T> end = design_.r1 * arm(at);
    if constexpr (E.hanger) return end + T(-scene_.counterweight_hanger) * hanger(at);
    return end;
  }

  /// The end of the throwing arm, where the sling is attached.
  Vector<T> arm_tip(const X& x) const { return -design_.r2 * arm(directions<E>(x)); }

  /// (10) (11)
  Vector<T> projectile(const X& x, const At& at) const {
    return -design_.r2 * arm(at) + -sling_length(x) * sling(at);
  }
  Vector<T> projectile(const X& x) const { return projectile(x, directions<E>(x)); }

  /// Velocity of the projectile, m/s: time derivative of (10) and (11).
  Vector<T> velocity(const X& x, const At& at) const {
    Vector<T> v =
        T(-design_.r2 * x[w1]) * turned(arm(at)) + T(-sling_length(x) * x[w2]) * turned(sling(at));
    if constexpr (E.elastic) v = v + -x[stretching] * sling(at);
    return v;
  }
  Vector<T> velocity(const X& x) const { return velocity(x, directions<E>(x)); }

  /// The acceleration of the projectile minus that of a free fall, m/s^2.
  Vector<T> specific_force(const X& x, const At& at, const X& dxdt) const {
    return projectile_force(tip_force(turning(x, at, dxdt)), x, at, dxdt);
  }

  /// Loads by Newton's second law from the accelerations of all masses; `normal` is the trough's
  /// force on the projectile, N. The stress is that under the bending moment of sling, weight and
  /// inertia of the throwing arm at the fulcrum; the whole of a measured beam counts as its
  /// throwing arm. The hanger's tension is the component along it of the force on the
  /// counterweight.
  Loads<T> loads(const X& x, const At& at, const X& dxdt, const T& normal) const {
    using std::sqrt;
    const auto& [r1, r3, r2] = design_;
    const T m1(scene_.counterweight_mass), m3(scene_.projectile_mass), ms(scene_.sling_mass);
    const Vector<T> up{T(0), T(scene_.gravity)}, a = arm(at), e = sling(at);
    const Vector<T> turn = turning(x, at, dxdt);
    const Vector<T> tip = tip_force(turn), end = projectile_force(tip, x, at, dxdt);
    Vector<T> tension = m3 * end + T(ms / T(2)) * (tip + end);
    if constexpr (E.trough) tension.y = tension.y - normal;
    Vector<T> on_counterweight = r1 * turn + up;
    if constexpr (E.hanger) {
      const Vector<T> b = hanger(at);
      const T r4(scene_.counterweight_hanger);
      on_counterweight =
          on_counterweight + T(-r4 * dxdt[w3]) * turned(b) + T(r4 * x[w3] * x[w3]) * b;
    }
    const Vector<T> axle =
        m1 * on_counterweight + beam_mass() * (T(-beam_centre()) * turn + up) + tension;
    Loads<T> loads;
    if constexpr (E.elastic)
      loads.projectile_tension = sling_tension(x);
    else
      loads.projectile_tension = m3 * dot(end, e);
    if constexpr (E.trough) loads.projectile_tension = loads.projectile_tension - normal * e.y;
    loads.tip_tension = dot(tension, e);
    loads.axle = sqrt(dot(axle, axle));
    loads.beam_stress = beam_stress(a, dxdt[w1], tension);
    if constexpr (E.hanger)
      loads.hanger_tension = m1 * dot(on_counterweight, hanger(at));
    else
      loads.hanger_tension = T(0);
    const T h0(scene_.fulcrum_height);
    loads.tip_height = h0 - r2 * a.y;
    loads.counterweight_height = h0 + r1 * a.y;
    if constexpr (E.hanger)
      loads.counterweight_height =
          loads.counterweight_height - T(scene_.counterweight_hanger) * hanger(at).y;
    loads.projectile_height = loads.tip_height - sling_length(x) * e.y;
    return loads;
  }

  CounterweightMasses counterweight_masses() const { return {scene_, E.hanger}; }

  const Scene& scene() const { return scene_; }
  const Design<T>& design() const { return design_; }

 private:
  /// Unit vector from the fulcrum to the counterweight.
  static Vector<T> arm(const At& at) { return {at[sin1], at[cos1]}; }

  /// Unit vector from the projectile to the arm's tip.
  static Vector<T> sling(const At& at) { return {at[sin2], at[cos2]}; }

  /// Unit vector from the counterweight to the hinge.
  static Vector<T> hanger(const At& at) { return {at[sin3], at[cos3]}; }

  /// Derivative of a unit vector with respect to its angle.
  static Vector<T> turned(const Vector<T>& a) { return {a.y, -a.x}; }

  /// Acceleration of a point at unit distance along the counterweight's arm.
  static Vector<T> turning(const X& x, const At& at, const X& dxdt) {
    const Vector<T> a = arm(at);
    return dxdt[w1] * turned(a) + T(-x[w1] * x[w1]) * a;
  }

  /// Acceleration of the arm's tip, from turning(); gravity acts like an upward acceleration.
  Vector<T> tip_force(const Vector<T>& turn) const {
    return -design_.r2 * turn + Vector<T>{T(0), T(scene_.gravity)};
  }

  /// The same of the projectile, from that of the tip.
  Vector<T> projectile_force(const Vector<T>& tip, const X& x, const At& at, const X& dxdt) const {
    const T l = sling_length(x);
    T along = l * x[w2] * x[w2], across = -l * dxdt[w2];
    if constexpr (E.elastic) {
      along = along - dxdt[stretching];
      across = across - T(2) * x[stretching] * x[w2];
    }
    const Vector<T> e = sling(at);
    return tip + along * e + across * turned(e);
  }

  /// See loads().
  T beam_stress(const Vector<T>& a, const T& acceleration1, const Vector<T>& tension) const {
    const T& r2 = design_.r2;
    T inertia, weight;  // the torque of the weight is that of a horizontal arm
    if (scene_.beam_mass) {
      inertia = T(*scene_.beam_moment);
      weight = T(*scene_.beam_mass * *scene_.beam_centre * scene_.gravity);
    } else {
      const auto [width, depth] = beam_section(scene_);
      const double per_metre = scene_.beam_density * width * depth;
      const double turning = scene_.beam_inertia == BeamInertia::none ? 0 : per_metre / 3;
      inertia = T(turning) * r2 * r2 * r2;
      weight = T(per_metre * scene_.gravity / 2) * r2 * r2;
    }
    const T bending = inertia * acceleration1 + weight * a.x - r2 * dot(tension, turned(a));
    return T(stress_per_moment(scene_)) * bending;
  }

  Scene scene_;
  Design<T> design_;
};

}  // namespace trebsweep
