#pragma once

#include <cstdint>

#include "trebsweep/model/state.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// The end of a swing.
template <class Number, Effects E = Effects{}>
struct Outcome {
  Status status;
  Number t;                       ///< s: time of the release, or the last time reached
  State<Number, E> x;             ///< state at t
  Number speed;                   ///< m/s; only of a release
  std::uint64_t steps;            ///< accepted and rejected
  std::uint64_t evaluations = 0;  ///< of the right-hand side; set for single swings only
};

}  // namespace trebsweep
