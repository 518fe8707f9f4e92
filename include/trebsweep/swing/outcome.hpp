#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "trebsweep/model/state.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// The end of a swing.
template <class Number, Effects E = Effects{}>
struct Outcome {
  Status status;
  Number t;             ///< s: time of the release, or the last time reached
  State<Number, E> x;   ///< state at t
  Number speed;         ///< m/s; only of a release
  std::uint64_t steps;  ///< accepted and rejected
};

/// The result of a swing. Without a release, its speed and time are NaN, and `values`, which belong
/// to its fields, are set to NaN.
template <Effects E>
SwingResult result_of(const Outcome<double, E>& outcome, std::span<double> values) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (has_speed(outcome.status)) return {outcome.speed, outcome.t, outcome.steps, outcome.status};
  std::fill(values.begin(), values.end(), nan);
  return {nan, nan, outcome.steps, outcome.status};
}

}  // namespace trebsweep
