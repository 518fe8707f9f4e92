#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {

/// What ends a swing with a shot.
enum class Release {
  crossing,  ///< phi1 = pi for the first time, met exactly
  window     ///< the paper's rule: the first step with |pi - phi1| < release_window
};

/// In the order of Release.
inline constexpr std::array<std::string_view, 2> release_names{"crossing", "window"};

/// How swings are integrated. The defaults keep the speeds of the paper's lattice within 1e-7 m/s.
struct Solver {
  std::string stepper = "fehlberg78";  ///< one of stepper_names
  double time_step = 0.01;             ///< s: a fixed stepper's step; the paper's
  double tolerance = 1e-9;             ///< absolute and relative error allowed in an adaptive step
  double target_error = 0;             ///< m/s: of speeds, to choose the tolerance by; 0: not given
  Release release = Release::crossing;
  double release_window = 0.05;       ///< rad; the paper's
  double max_time = 10;               ///< s: a swing not released by then counts as not_released
  std::uint64_t max_steps = 1000000;  ///< steps tried per swing, rejected ones included
};

/// The step (s) of a solver with a fixed stepper, else its tolerance.
inline double setting(const Solver& solver) {
  return follows_tolerance(solver.stepper) ? solver.tolerance : solver.time_step;
}

/// A solver with that stepper and setting() that locates phi1 = pi; the rest is copied from
/// `limits`.
inline Solver solver_of(const std::string& stepper, double setting, const Solver& limits) {
  Solver solver = limits;
  solver.stepper = stepper;
  solver.release = Release::crossing;
  (follows_tolerance(stepper) ? solver.tolerance : solver.time_step) = setting;
  return solver;
}

}  // namespace trebsweep
