#pragma once

#include <limits>

#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// Whether the projectile is below the ground, where there is no range.
template <class T, Effects E>
auto is_below_ground(const Mechanism<T, E>& mechanism, const State<T, E>& x) {
  return T(mechanism.scene().fulcrum_height) + mechanism.projectile(x).y < T(0);
}

/// The horizontal distance (m) from the release to the impact on the ground, without drag; NaN if
/// the projectile is below the ground.
template <class T, Effects E>
T drag_free_range(const Mechanism<T, E>& mechanism, const State<T, E>& x) {
  using std::sqrt;
  const Scene& scene = mechanism.scene();
  const auto velocity = mechanism.velocity(x);
  const T g(scene.gravity), height = T(scene.fulcrum_height) + mechanism.projectile(x).y;
  const T square = velocity.y * velocity.y + T(2) * g * height;
  const T nan = std::numeric_limits<double>::quiet_NaN();
  const T flight_time = T(velocity.y + sqrt(select(square > T(0), square, T(0)))) / g;
  return select(height < T(0), nan, T(velocity.x * flight_time));
}

/// The value of a field at the release in state x, for the fields that are not in SwingResult and
/// do not have an integration of their own.
template <class T, Effects E>
T value_at_release(Field field, const Mechanism<T, E>& mechanism, const State<T, E>& x,
                   const SwingRecord<T>& record) {
  const Scene& scene = mechanism.scene();
  const auto kinetic_energy = [&] {
    const T speed = mechanism.speed(x);
    return T(T(scene.projectile_mass / 2) * speed * speed);
  };
  const auto at_start = [&] { return start<T, E>(scene, mechanism.design()); };
  const auto potential_energy_released = [&] {
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
      return kinetic_energy();
    case Field::efficiency:
      return kinetic_energy() / potential_energy_released();
    case Field::range:
      return drag_free_range(mechanism, x);
    case Field::energy_drift:
      return T(T(mechanism.energy(x) + record.loss) - mechanism.energy(at_start())) /
             potential_energy_released();
    case Field::slack:  // the tension of an elastic sling is never negative
      return select(E.elastic ? record.least_tension <= T(0) : record.least_tension < T(0), T(2),
                    T(1));
    case Field::least_sling_tension:
      // The polynomial through samples of an elastic sling's tension may fall below zero.
      return E.elastic ? select(record.least_tension > T(0), record.least_tension, T(0))
                       : record.least_tension;
    case Field::peak_sling_tension:
      return record.peak_tension;
    case Field::peak_axle_load:
      return record.peak_axle_load;
    case Field::peak_beam_stress:
      return record.peak_stress;
    case Field::speed:
    case Field::release_time:
    case Field::status:
    case Field::steps:
    case Field::speed_error:
    case Field::stiffness:
    case Field::decay_rate:
      break;
  }
  return T(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace trebsweep
