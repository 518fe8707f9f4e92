#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace trebsweep {

/// The quantities that a sweep can map over the lattice. Each is computed only if requested.
enum class Field {
  speed,
  release_time,
  status,
  sling_angle,
  arm_rate,
  sling_rate,
  kinetic_energy,
  efficiency,
  range,
  energy_drift,
  steps,
  speed_error,
  stiffness,
  decay_rate,
  slack,
  least_sling_tension,
  peak_sling_tension,
  peak_axle_load,
  peak_beam_stress,
  flight_time,
  impact_speed,
  apex,
  lift_off_time,
  arm_angle,
  pin_angle,
  peak_hanger_tension,
  least_hanger_tension,
  ground_clearance,
  tip_clearance,
  counterweight_clearance,
  projectile_clearance
};

/// How a field is computed.
enum class FieldKind {
  result,      ///< part of every SwingResult
  at_release,  ///< from the state at the release
  flight,      ///< of the flight from the release to the ground
  lift_off,    ///< from the lift-off
  load,        ///< from the loads along the whole swing
  separate     ///< by an additional integration
};

/// Name and description of a field.
struct FieldInfo {
  Field field;
  std::string_view name;   ///< in job files; datasets have `_` for `-`
  std::string_view units;  ///< UDUNITS; empty for flags
  FieldKind kind;
  std::string_view meaning;  ///< CF long_name
};

/// In the order of Field.
inline constexpr auto field_info = std::to_array<FieldInfo>({
    {Field::speed, "speed", "m s-1", FieldKind::result, "speed of the projectile at release"},
    {Field::release_time, "release-time", "s", FieldKind::result,
     "time from the start to the release"},
    {Field::status, "status", "", FieldKind::result, "outcome of the design"},
    {Field::sling_angle, "sling-angle", "rad", FieldKind::at_release,
     "angle of the sling from the downward vertical at release"},
    {Field::arm_rate, "arm-rate", "rad s-1", FieldKind::at_release,
     "rate of the arm's angle at release"},
    {Field::sling_rate, "sling-rate", "rad s-1", FieldKind::at_release,
     "rate of the sling's angle at release"},
    {Field::kinetic_energy, "kinetic-energy", "J", FieldKind::at_release,
     "kinetic energy of the projectile at release"},
    {Field::efficiency, "efficiency", "1", FieldKind::at_release,
     "kinetic energy of the projectile at release over the potential energy released"},
    {Field::range, "range", "m", FieldKind::flight,
     "horizontal distance from the foot of the fulcrum to the impact on the ground, positive in "
     "the direction of the throw"},
    {Field::energy_drift, "energy-drift", "1", FieldKind::at_release,
     "energy at release plus losses minus initial energy, over the potential energy released"},
    {Field::steps, "steps", "1", FieldKind::result, "steps, accepted and rejected"},
    {Field::speed_error, "speed-error", "m s-1", FieldKind::separate,
     "speed at release minus that of a far more accurate integration"},
    {Field::stiffness, "stiffness", "s-1", FieldKind::separate,
     "largest modulus of the eigenvalues of the Jacobian along the swing"},
    {Field::decay_rate, "decay-rate", "s-1", FieldKind::separate,
     "largest decay rate of the eigenvalues of the Jacobian along the swing"},
    {Field::slack, "slack", "", FieldKind::load,
     "whether the sling would go slack before the release"},
    {Field::least_sling_tension, "least-sling-tension", "N", FieldKind::load,
     "smallest tension of the sling at the projectile"},
    {Field::peak_sling_tension, "peak-sling-tension", "N", FieldKind::load,
     "largest tension of the sling at the arm"},
    {Field::peak_axle_load, "peak-axle-load", "N", FieldKind::load, "largest force on the axle"},
    {Field::peak_beam_stress, "peak-beam-stress", "Pa", FieldKind::load,
     "largest bending stress of the beam at the fulcrum"},
    {Field::flight_time, "flight-time", "s", FieldKind::flight,
     "time from the release to the impact"},
    {Field::impact_speed, "impact-speed", "m s-1", FieldKind::flight,
     "speed of the projectile at the impact"},
    {Field::apex, "apex", "m", FieldKind::flight,
     "greatest height of the projectile above the ground after the release"},
    {Field::lift_off_time, "lift-off-time", "s", FieldKind::lift_off,
     "time from the start to the projectile's lift-off from the trough"},
    {Field::arm_angle, "arm-angle", "rad", FieldKind::at_release,
     "angle of the counterweight's arm from the upward vertical at release"},
    {Field::pin_angle, "pin-angle", "rad", FieldKind::at_release,
     "angle between the sling and the continuation of the throwing arm at release"},
    {Field::peak_hanger_tension, "peak-hanger-tension", "N", FieldKind::load,
     "largest tension of the counterweight's hanger"},
    {Field::least_hanger_tension, "least-hanger-tension", "N", FieldKind::load,
     "smallest tension of the counterweight's hanger, negative under compression"},
    {Field::ground_clearance, "ground-clearance", "m", FieldKind::load,
     "smallest height above the ground of the arm's tip, the counterweight and, unless it lies in "
     "the trough, the projectile"},
    {Field::tip_clearance, "tip-clearance", "m", FieldKind::load,
     "smallest height of the arm's tip above the ground"},
    {Field::counterweight_clearance, "counterweight-clearance", "m", FieldKind::load,
     "smallest height of the counterweight above the ground"},
    {Field::projectile_clearance, "projectile-clearance", "m", FieldKind::load,
     "smallest height of the projectile above the ground, from its lift-off if it starts in a "
     "trough"},
});
static_assert(std::all_of(field_info.begin(), field_info.end(), [](const FieldInfo& info) {
  return &info - field_info.data() == static_cast<std::ptrdiff_t>(info.field);
}));

inline constexpr const FieldInfo& info(Field field) {
  return field_info[static_cast<std::size_t>(field)];
}

/// Whether the values of a field are flags.
inline constexpr bool is_flag(Field field) {
  return field == Field::status || field == Field::slack;
}

/// Names of the flags 0 (no release), 1 and 2 of the field slack.
inline constexpr std::array<std::string_view, 3> slack_names{"no_release", "taut", "slack"};

/// Whether a field is a continuous quantity of the machine, rather than a flag or a property of the
/// integration: only such a field can be an objective or be constrained.
inline constexpr bool is_quantity(Field field) {
  return !is_flag(field) && info(field).kind != FieldKind::separate && field != Field::steps &&
         field != Field::energy_drift;
}

/// Whether a field is computed while the swing is integrated.
inline constexpr bool is_of_swing(Field field) {
  return info(field).kind != FieldKind::result && info(field).kind != FieldKind::separate;
}

}  // namespace trebsweep
