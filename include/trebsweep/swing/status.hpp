#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace trebsweep {

/// The outcome of a design, as stored in the status map; 0 is the fill value of the map.
enum class Status : std::uint8_t {
  outside_lattice,        ///< not a design of the lattice
  released,               ///< has a release
  not_released,           ///< no release before max-time, or none above the ground
  unreachable_start,      ///< r1 < |h - h0 + r4|: the arm does not reach the start height
  step_budget,            ///< neither a release nor max-time within max-steps
  step_underflow,         ///< the tolerance requires steps too short to change the time
  non_finite,             ///< the state became infinite or NaN
  released_below_ground,  ///< has a release below the ground; only if a field of the flight is
                          ///< requested
  never_lifted,           ///< the projectile was still in the trough when the swing ended
  sling_too_short         ///< the sling does not reach the trough at the start
};

/// Whether designs with that status have a release and a speed.
inline constexpr bool has_speed(Status status) {
  return status == Status::released || status == Status::released_below_ground;
}

/// Names of the statuses, in the order of their values.
inline constexpr std::array<std::string_view, 10> status_names{
    "outside_lattice", "released",       "not_released", "unreachable_start",
    "step_budget",     "step_underflow", "non_finite",   "released_below_ground",
    "never_lifted",    "sling_too_short"};

inline constexpr std::string_view name_of(Status status) {
  return status_names[static_cast<std::size_t>(status)];
}

}  // namespace trebsweep
