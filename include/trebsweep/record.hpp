#pragma once

#include <limits>

#include "trebsweep/field.hpp"
#include "trebsweep/stepper.hpp"

namespace trebsweep {

/// What has been seen along a swing.
template <class T>
struct Record {
  T least_pull = std::numeric_limits<double>::infinity();  ///< N, of the sling on the projectile
  T peak_pull = 0;                                         ///< N, of the sling on the arm's tip
  T peak_axle = 0;                                         ///< N
  T peak_stress = 0;                                       ///< Pa
  T loss = 0;                                              ///< J, to friction
};

/// The larger of `largest` and a quantity's maximum about the middle one of three values: that of
/// the parabola through them, where it lies between them. The middle one is `part` of the way
/// between the others.
template <class T>
T larger_peak(const T& largest, const T& first, const T& middle, const T& last, double part) {
  // Newton's divided differences over a way of length one.
  const T rise = T(middle - first) / T(part);
  const T bend = T(last - first) - rise;  // times (1 - part)
  const T curvature = bend / T(1 - part);
  const T top = T(part / 2) - rise / T(T(2) * select(curvature < T(0), curvature, T(-1)));
  const T value = first + top * T(rise + T(top - T(part)) * curvature);
  const auto inside = (curvature < T(0)) & (top > T(0)) & (top < T(1));
  T most = select(largest > middle, largest, middle);
  most = select(most > first, most, first);
  most = select(most > last, most, last);
  return select(inside & (value > most), value, most);
}

/// A record continued over a step: by the loads and losses at the places of Lobatto's quadrature
/// with five points, to which the stepper goes from the step's start.
template <class Stepper, class T, Effects E>
Record<T> watch(Record<T> record, Stepper& stepper, const Motion<T, E>& motion,
                const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                const Instant<T, E>& to, const T& h) {
  constexpr double early = 0.17267316464601143;  // (1 - sqrt(3/7))/2
  constexpr std::array<double, 3> inside{early, 0.5, 1 - early};
  constexpr std::array<double, 5> weights{1.0 / 20, 49.0 / 180, 16.0 / 45, 49.0 / 180, 1.0 / 20};
  std::array<Instant<T, E>, 5> at;
  at.front() = from;
  at.back() = to;
  State<T, E> error;
  for (std::size_t i = 0; i < 3; ++i)
    advance(stepper, motion, from, T(T(inside[i]) * h), at[i + 1], error);
  std::array<Loads<T>, 5> loads;
  T loss = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    loads[i] = mechanism.loads(at[i].x, at[i].dxdt);
    if constexpr (E.pivot || E.elastic) loss += T(weights[i]) * mechanism.dissipation(at[i].x);
  }
  record.loss += h * loss;
  const std::array<double, 5> places{0, inside[0], inside[1], inside[2], 1};
  for (std::size_t i = 1; i < 4; ++i) {
    const double part = (places[i] - places[i - 1]) / (places[i + 1] - places[i - 1]);
    const auto peak = [&](const T& largest, T Loads<T>::*load) {
      return larger_peak(largest, loads[i - 1].*load, loads[i].*load, loads[i + 1].*load, part);
    };
    record.least_pull =
        -larger_peak(T(-record.least_pull), T(-loads[i - 1].projectile_pull),
                     T(-loads[i].projectile_pull), T(-loads[i + 1].projectile_pull), part);
    record.peak_pull = peak(record.peak_pull, &Loads<T>::tip_pull);
    record.peak_axle = peak(record.peak_axle, &Loads<T>::axle);
    record.peak_stress = peak(record.peak_stress, &Loads<T>::beam_stress);
  }
  return record;
}

/// Whether a field of a scene needs a Record.
inline bool needs_record(Field field, const Scene& scene) {
  return is_load(field) || (field == Field::energy_drift && is_dissipative(scene));
}

/// Whether the projectile is below the ground, where it has no range.
template <class T, Effects E>
auto is_below_ground(const Mechanism<T, E>& mechanism, const State<T, E>& x) {
  return T(mechanism.scene().fulcrum_height) + mechanism.projectile(x).y < T(0);
}

/// A field's value at a release; not of those that Shot has: speed, release-time, status, steps.
template <class T, Effects E>
T value_at_release(Field field, const Mechanism<T, E>& mechanism, const State<T, E>& x,
                   const Record<T>& record) {
  using std::sqrt;
  const Scene& scene = mechanism.scene();
  const auto kinetic = [&] {
    const T speed = mechanism.speed(x);
    return T(T(scene.projectile_mass / 2) * speed * speed);
  };
  const auto at_start = [&] { return start<T, E>(scene, mechanism.design()); };
  const auto given_up = [&] {
    return T(mechanism.potential_energy(at_start()) - mechanism.potential_energy(x));
  };
  switch (field) {
    case Field::sling_angle:
      return x[phi2];
    case Field::arm_rate:
      return x[w1];
    case Field::sling_rate:
      return x[w2];
    case Field::kinetic_energy:
      return kinetic();
    case Field::efficiency:
      return kinetic() / given_up();
    case Field::range: {
      const auto velocity = mechanism.velocity(x);
      const T g(scene.gravity), height = T(scene.fulcrum_height) + mechanism.projectile(x).y;
      const T fall = velocity.y * velocity.y + T(2) * g * height;
      const T none = std::numeric_limits<double>::quiet_NaN();
      const T flight = T(velocity.y + sqrt(select(fall > T(0), fall, T(0)))) / g;
      return select(height < T(0), none, T(velocity.x * flight));
    }
    case Field::energy_drift:
      return T(T(mechanism.energy(x) + record.loss) - mechanism.energy(at_start())) / given_up();
    case Field::slack:  // an elastic sling does not push: its pull ends at zero
      return select(E.elastic ? record.least_pull <= T(0) : record.least_pull < T(0), T(2), T(1));
    case Field::least_sling_tension:
      // Nor below: the parabola through its samples may.
      return E.elastic ? select(record.least_pull > T(0), record.least_pull, T(0))
                       : record.least_pull;
    case Field::peak_sling_tension:
      return record.peak_pull;
    case Field::peak_axle_load:
      return record.peak_axle;
    case Field::peak_beam_stress:
      return record.peak_stress;
    default:
      return T(std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace trebsweep
