#pragma once

#include <limits>

#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// The value of a field at the release in state x, for the fields that are not in SwingResult and
/// do not have an integration of their own. The record and the flight need only hold the quantities
/// that the field uses.
template <class T, Effects E>
T value_at_release(Field field, const Mechanism<T, E>& mechanism, const State<T, E>& x,
                   const SwingRecord<T>& record, const Flight<T>& flight) {
  const Scene& scene = mechanism.scene();
  const auto kinetic_energy = [&] {
    const T speed = mechanism.speed(x);
    return T(T(scene.projectile_mass / 2) * speed * speed);
  };
  const auto at_start = [&] { return start<T, E>(scene, mechanism.design()); };
  const auto potential_energy_released = [&] {
    return T(mechanism.potential_energy(at_start()) - mechanism.potential_energy(x));
  };
  const auto projectile_clearance = [&] {
    const T& least = record.projectile_clearance;
    // Rounding errors just after the lift-off do not count.
    const T trough(scene.trough_height), almost(scene.trough_height - ground_rounding);
    return E.trough ? select((least > almost) & (least < trough), trough, least) : least;
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
      return flight.range;
    case Field::flight_time:
      return flight.time;
    case Field::impact_speed:
      return flight.impact_speed;
    case Field::apex:
      return flight.apex;
    case Field::lift_off_time:
      return record.lift_off_time;
    case Field::arm_angle:
      return x[phi1];
    case Field::pin_angle:
      return x[phi1] - x[phi2];
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
    case Field::ground_clearance:
      return smaller(smaller(record.tip_clearance, record.counterweight_clearance),
                     projectile_clearance());
    case Field::projectile_clearance:
      return projectile_clearance();
    case Field::peak_sling_tension:
    case Field::peak_axle_load:
    case Field::peak_beam_stress:
    case Field::peak_hanger_tension:
    case Field::least_hanger_tension:
    case Field::tip_clearance:
    case Field::counterweight_clearance:
    case Field::speed:
    case Field::release_time:
    case Field::status:
    case Field::steps:
    case Field::speed_error:
    case Field::stiffness:
    case Field::decay_rate:
      break;
  }
  for (const LoadExtreme<T>& load : load_extremes<T>)
    if (load.field == field) return record.*load.extreme;
  return T(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace trebsweep
