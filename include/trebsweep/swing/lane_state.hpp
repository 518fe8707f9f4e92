#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/swing/outcome.hpp"

namespace trebsweep {

/// A set of lanes; bit i belongs to lane i.
using LaneMask = std::uint32_t;

inline std::size_t first_lane(LaneMask mask) {
  return static_cast<std::size_t>(std::countr_zero(mask));
}

/// The swing under way in every lane, except for its current instant.
template <class T, Effects E>
struct LaneState {
  Design<T> design;
  Motion<T, E> motion;
  T h;  ///< s: length of the next step; the same in all lanes of a fixed-step method
};

/// The swing in a lane. Steps are counted over all lanes.
template <class Number>
struct LaneOwner {
  std::uint64_t index;       // of its design
  std::uint64_t first_step;  // the steps taken when it began
  // Of a fixed-step method: the steps taken and the time (s) at its start or lift-off.
  std::uint64_t origin_step;
  Number origin_time;

  /// The time after a step of a fixed-step method, n h from the origin, which accumulates no
  /// rounding errors.
  Number time_after(std::uint64_t step, double time_step) const {
    return origin_time + Number(Number(step - origin_step) * Number(time_step));
  }
};

/// The number of parts of a step that are searched separately for lift-offs and best moments:
/// adaptive methods take long steps.
template <class T, Effects E>
int parts_to_search(const AnyStepper<T, E>& stepper) {
  return stepper.adaptive ? 4 : 1;
}

/// The time between two instants, s; a negligible one where it would be zero, because steppers need
/// a positive length.
template <class T, Effects E>
T step_between(const Instant<T, E>& from, const Instant<T, E>& to) {
  const T h = to.t - from.t;
  return select(h > T(0), h, T(1e-30));
}

/// Whether state and rates of a lane are finite.
template <class T, Effects E>
bool is_finite(const Instant<T, E>& at, std::size_t lane) {
  using Number = typename Lanes<T>::Number;
  Number sum = 0;
  for (std::size_t i = 0; i < coordinates<E>; ++i)
    sum += Number(get_lane(at.x[i], lane) + get_lane(at.dxdt[i], lane));
  return is_finite_sum(sum);
}

/// The outcome of the swing in a lane that ends at the instant `at`.
template <class T, Effects E>
auto outcome_of(Status status, const Instant<T, E>& at, std::size_t lane,
                const typename Lanes<T>::Number& speed, std::uint64_t steps) {
  Outcome<typename Lanes<T>::Number, E> outcome{status, get_lane(at.t, lane), {}, speed, steps};
  for (std::size_t i = 0; i < coordinates<E>; ++i) outcome.x[i] = get_lane(at.x[i], lane);
  return outcome;
}

/// max-time (s) with an allowance for rounding: the times of fixed steps, n h, are rounded.
template <class Number>
Number latest_time(const Solver& solver) {
  return Number(solver.max_time) * Number(1 + 4 * std::numeric_limits<double>::epsilon());
}

/// The number of steps after which a swing may have to end.
inline std::uint64_t step_limit(const Solver& solver, bool adaptive) {
  if (adaptive) return solver.max_steps;
  const double steps = std::ceil(solver.max_time / solver.time_step * (1 - 4e-16));
  return steps < static_cast<double>(solver.max_steps)
             ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(steps))
             : solver.max_steps;
}

}  // namespace trebsweep
