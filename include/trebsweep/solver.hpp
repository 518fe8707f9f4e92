#pragma once

#include <cstdint>
#include <string>

namespace trebsweep {

/// What ends a swing with a shot.
enum class Release {
  crossing,  ///< phi1 = pi for the first time, met exactly
  window     ///< the paper's rule: the first step with |pi - phi1| < release_window
};

/// How swings are integrated; the defaults are the paper's.
struct Solver {
  std::string stepper = "euler";  ///< one of stepper_names
  double time_step = 0.01;        ///< s: a fixed stepper's step
  double tolerance = 1e-9;        ///< absolute and relative error allowed in one adaptive step
  double target_error = 0;        ///< m/s: of speeds, to choose the tolerance by; 0: it is given
  Release release = Release::window;
  double release_window = 0.05;       ///< rad
  double max_time = 10;               ///< s: a swing not released by then counts as not_released
  std::uint64_t max_steps = 1000000;  ///< steps tried per swing, rejected ones included
};

}  // namespace trebsweep
