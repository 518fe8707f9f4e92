#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace trebsweep {

/// A quantity that a sweep can map over the lattice. Each is computed only where it is asked for.
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
  peak_beam_stress
};

/// How a field is called and described.
struct FieldInfo {
  std::string_view name;     ///< in job files; datasets have `_` for `-`
  std::string_view units;    ///< UDUNITS; empty for flags
  std::string_view meaning;  ///< CF long_name
};

/// In the order of Field.
inline constexpr std::array<FieldInfo, 19> field_info{{
    {"speed", "m s-1", "speed of the projectile at release"},
    {"release-time", "s", "time from the start to the release"},
    {"status", "", "what became of the design"},
    {"sling-angle", "rad", "angle of the sling from the downward vertical at release"},
    {"arm-rate", "rad s-1", "rate of the arm's angle at release"},
    {"sling-rate", "rad s-1", "rate of the sling's angle at release"},
    {"kinetic-energy", "J", "kinetic energy of the projectile at release"},
    {"efficiency", "1", "projectile's kinetic energy over the potential energy given up"},
    {"range", "m",
     "horizontal distance from the point of release to the point of impact of a free flight in "
     "vacuum, positive in the direction in which the arm's tip moves at phi1 = pi"},
    {"energy-drift", "1",
     "energy and losses at release less energy at the start, over that given up"},
    {"steps", "1", "steps tried"},
    {"speed-error", "m s-1", "speed at release less that of fehlberg78 at a tolerance of 1e-12"},
    {"stiffness", "s-1", "largest modulus of the Jacobian's eigenvalues along the swing"},
    {"decay-rate", "s-1", "largest decay rate among the Jacobian's eigenvalues along the swing"},
    {"slack", "", "whether the sling would go slack before the release"},
    {"least-sling-tension", "N", "least pull of the sling on the projectile"},
    {"peak-sling-tension", "N", "largest pull of the sling on the arm"},
    {"peak-axle-load", "N", "largest force on the axle"},
    {"peak-beam-stress", "Pa", "largest bending stress of the beam at the fulcrum"},
}};

inline constexpr const FieldInfo& info(Field field) {
  return field_info[static_cast<std::size_t>(field)];
}

/// Whether the field has flags for values, and not numbers.
inline constexpr bool is_flag(Field field) {
  return field == Field::status || field == Field::slack;
}

/// Names of the field slack's flags: of designs without a shot, and then of 1 and 2.
inline constexpr std::array<std::string_view, 3> slack_names{"no_shot", "taut", "slack"};

/// Whether every SwingResult has it.
inline constexpr bool is_basic(Field field) {
  return field == Field::speed || field == Field::release_time || field == Field::status ||
         field == Field::steps;
}

/// Whether the field takes an integration of its own, beside the swing's.
inline constexpr bool is_separate(Field field) {
  return field == Field::speed_error || field == Field::stiffness || field == Field::decay_rate;
}

/// Whether the field looks at the loads all along the swing.
inline constexpr bool is_load(Field field) { return field >= Field::slack; }

}  // namespace trebsweep
