#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace trebsweep {

/// The outcome of a design, as stored in the status map; 0 is the fill value of the map.
enum class Status : std::uint8_t {
  outside_lattice,
  released,
  not_released,
  unreachable_start,
  step_budget,
  step_underflow,
  non_finite,
  released_below_ground,  ///< only if a field of the flight is requested
  never_lifted,
  sling_too_short
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

/// What each status says of a design, in the order of their values.
inline constexpr std::array<std::string_view, status_names.size()> status_meanings{
    "not a design of the lattice",
    "the projectile is released",
    "no release before solver.max-time, or none above the ground",
    "the arm does not reach its initial height: r1 < |h - h0 + r4|, or r2 < |h0 - "
    "start-tip-height|",
    "neither a release nor solver.max-time within solver.max-steps",
    "the tolerance requires steps too short to change the time",
    "the state became infinite or NaN",
    "the projectile is released more than 1 micrometre below the ground",
    "the projectile is still in the trough when the swing ends",
    "the sling does not reach from the arm's tip to the trough at the start"};

inline constexpr std::string_view name_of(Status status) {
  return status_names[static_cast<std::size_t>(status)];
}

inline constexpr std::string_view meaning_of(Status status) {
  return status_meanings[static_cast<std::size_t>(status)];
}

}  // namespace trebsweep
