#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace trebsweep {

/// What became of a design, as stored in the status map; 0 is the map's fill value.
enum class Status : std::uint8_t {
  outside_lattice,       ///< no design of the lattice
  released,              ///< a shot
  not_released,          ///< the time limit came first
  unreachable_start,     ///< r1 < |h - h0|: the arm cannot hold the counterweight at its height
  step_budget,           ///< max-steps were tried before the release or the time limit
  step_underflow,        ///< the tolerance asked for a step too short to advance the clock
  non_finite,            ///< the state overflowed or became undefined
  released_below_ground  ///< a shot, but from below the ground: told apart where a range is asked
                         ///< for
};

/// Whether a design with that status has a speed.
inline constexpr bool has_speed(Status status) {
  return status == Status::released || status == Status::released_below_ground;
}

/// Names of the statuses, in the order of their values.
inline constexpr std::array<std::string_view, 8> status_names{
    "outside_lattice", "released",       "not_released", "unreachable_start",
    "step_budget",     "step_underflow", "non_finite",   "released_below_ground"};

}  // namespace trebsweep
