#pragma once

#include <cstdint>

#include "trebsweep/status.hpp"

namespace trebsweep {

/// What a map keeps of a design.
struct Shot {
  double speed;         ///< m/s, NaN without a release
  double release_time;  ///< s, NaN without a release
  std::uint64_t steps;  ///< tried
  Status status;
};

/// What the integration of some designs took.
struct Work {
  std::uint64_t lane_steps;   ///< made by lanes, idle ones too
  std::uint64_t evaluations;  ///< right-hand sides of the designs' steps
};

}  // namespace trebsweep
