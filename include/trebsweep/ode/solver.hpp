#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {

/// The rule of release: the event that ends a swing.
enum class Release {
  crossing,  ///< phi1 = release_angle for the first time, located by root finding
  window,    ///< the paper's rule: the end of the first step with |pi - phi1| < release_window
  pin,       ///< phi1 - phi2, the angle between the sling and the arm's continuation, falls to
             ///< pin_angle for the first time after lift-off, and before phi1 = 3 pi/2
  farthest,  ///< the largest range of releases by pins at all angles in (-pi, pi)
  fastest    ///< the largest speed of these
};

/// In the order of Release.
inline constexpr std::array<std::string_view, 5> release_names{"crossing", "window", "pin",
                                                               "farthest", "fastest"};

/// The steps of a swing that begin within it: not before `from` and before `until`, s.
struct TimeWindow {
  double from = 0, until = std::numeric_limits<double>::infinity();
};

/// How swings are integrated. With the defaults, the speeds of the paper's lattice are accurate to
/// 1.5e-8 m/s.
struct Solver {
  std::string stepper = "vern8";  ///< one of stepper_names
  double time_step = 0.01;        ///< s: step length of a fixed-step method; the paper's value
  double tolerance = 8e-9;        ///< absolute and relative, for the local error of a step
  double target_error = 0;        ///< m/s: desired error of the speeds, from which the
                                  ///< tolerance is chosen; 0: not given
  Release release = Release::crossing;
  double release_angle = std::numbers::pi;  ///< rad: phi1 of a crossing
  std::optional<double> pin_angle = {};     ///< rad: phi1 - phi2 at a release by a pin
  double release_window = 0.05;             ///< rad; the paper's value
  double max_time = 10;               ///< s: a swing without a release by then is not_released
  std::uint64_t max_steps = 1000000;  ///< per swing, accepted and rejected
  bool check = true;                  ///< whether a sweep measures the error of its speeds
  TimeWindow recorded = {};           ///< the steps that count for extremes; not a key
};

/// The step (s) of a solver with a fixed stepper, else its tolerance.
inline double setting(const Solver& solver) {
  return follows_tolerance(solver.stepper) ? solver.tolerance : solver.time_step;
}

/// The rule of release for results that converge with the steps: that of a job, where window, whose
/// release depends on the steps, becomes crossing.
inline Release located(Release rule) { return rule == Release::window ? Release::crossing : rule; }

/// Whether a rule of release chooses the best of the moments at which a pin can release.
inline bool takes_best_moment(Release rule) {
  return rule == Release::farthest || rule == Release::fastest;
}

/// A solver with that stepper and setting() and a located() release; the rest is copied from
/// `limits`.
inline Solver solver_of(const std::string& stepper, double setting, const Solver& limits) {
  Solver solver = limits;
  solver.stepper = stepper;
  solver.release = located(solver.release);
  (follows_tolerance(stepper) ? solver.tolerance : solver.time_step) = setting;
  return solver;
}

}  // namespace trebsweep
