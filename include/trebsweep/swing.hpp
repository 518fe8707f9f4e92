#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "trebsweep/release.hpp"
#include "trebsweep/solver.hpp"
#include "trebsweep/stepper.hpp"

namespace trebsweep {

/// What became of a design, as stored in the status map; 0 is the map's fill value.
enum class Status : std::uint8_t {
  outside_lattice,    ///< no design of the lattice
  released,           ///< a shot
  not_released,       ///< the time limit came first
  unreachable_start,  ///< r1 < |h - h0|: the arm cannot hold the counterweight at its height
  step_budget,        ///< max-steps were tried before the release or the time limit
  step_underflow,     ///< the tolerance asked for a step too short to advance the clock
  non_finite          ///< the state overflowed or became undefined
};

/// Names of the statuses, in the order of their values.
inline constexpr std::array<std::string_view, 7> status_names{
    "outside_lattice", "released",       "not_released", "unreachable_start",
    "step_budget",     "step_underflow", "non_finite"};

/// How a swing ended.
template <class T>
struct Outcome {
  Status status;
  Instant<T> end;       ///< the release, or the last moment reached
  std::uint64_t steps;  ///< steps tried
};

/// An observer that looks at nothing.
struct Unobserved {
  template <class... Arguments>
  void operator()(const Arguments&...) const {}
};

template <class T>
bool is_finite(const Instant<T>& at) {
  using std::isfinite;
  for (std::size_t i = 0; i < at.x.size(); ++i)
    if (!isfinite(at.x[i]) || !isfinite(at.dxdt[i])) return false;
  return true;
}

/// The largest error of a step in units of what the tolerance allows, in the measure of Odeint's
/// default_error_checker; infinite where the step's end or error is not finite. Odeint's own test
/// lets NaN pass: its comparisons with NaN are all false.
template <class T>
T error_ratio(const Instant<T>& from, const Instant<T>& to, const State<T>& error,
              const T& tolerance) {
  using std::abs;
  using std::isfinite;
  if (!is_finite(to)) return std::numeric_limits<T>::infinity();
  const T h = to.t - from.t;
  T largest = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    const T scale = T(1) + abs(from.x[i]) + abs(h * from.dxdt[i]);
    const T ratio = abs(error[i]) / (tolerance * scale);
    if (!isfinite(ratio)) return std::numeric_limits<T>::infinity();
    if (ratio > largest) largest = ratio;
  }
  return largest;
}

/// By how much to change the step after an error_ratio: the usual law (Hairer, Norsett and Wanner,
/// Solving Ordinary Differential Equations I, II.4), between a fifth and five times.
template <class T>
T step_factor(const T& error_ratio, int error_order) {
  using std::pow;
  const T factor = T(0.9) * pow(error_ratio, T(-1) / T(error_order + 1));
  return factor < T(0.2) ? T(0.2) : factor > T(5) ? T(5) : factor;
}

/// The paper's rule: whether a step's end lies inside the window around pi.
template <class T>
bool is_inside_window(const Instant<T>& at, const T& window) {
  using std::abs;
  return abs(boost::math::constants::pi<T>() - at.x[phi1]) < window;
}

/// What became of a step that was tried.
enum class Trial { accepted, rejected, too_short, non_finite };

/// Tries the next step, the `steps`-th of its swing, and sets the length `h` of the one after it.
template <class Stepper, class T>
Trial try_step(Stepper& stepper, const Motion<T>& motion, const Solver& solver,
               const Instant<T>& now, std::uint64_t steps, T& h, Instant<T>& next) {
  State<T> error;
  if constexpr (is_adaptive<Stepper>) {
    const T max_time(solver.max_time);
    const bool reaches_end = now.t + h >= max_time;
    if (reaches_end) h = max_time - now.t;
    next = advance(stepper, motion, now, h, error);
    const T ratio = error_ratio(now, next, error, T(solver.tolerance));
    h *= step_factor(ratio, stepper.error_order());
    if (ratio <= T(1)) {
      if (reaches_end) next.t = max_time;
      return Trial::accepted;
    }
    // Too short: it would not move the clock on; near t = 0, the first try stands for the time.
    const T clock = now.t > T(solver.time_step) ? now.t : T(solver.time_step);
    if (h >= std::numeric_limits<T>::epsilon() * clock) return Trial::rejected;
    return is_finite(next) ? Trial::too_short : Trial::non_finite;
  } else {
    next = advance(stepper, motion, now, h, error);
    next.t = T(steps) * h;  // counted, so that it carries no sum of roundings
    return is_finite(next) ? Trial::accepted : Trial::non_finite;
  }
}

/// Integrates one design from rest to its release, or to the reason why there is none.
///
/// `observe(from, to, at)` sees every accepted step, the last one cut at the release; at(t) is the
/// Instant at a time within the step.
template <class Stepper, class T, class Observe>
Outcome<T> swing(const Motion<T>& motion, const Solver& solver, Observe&& observe) {
  Stepper stepper;
  Instant<T> now{T(0), motion.start(), {}};
  motion(now.x, now.dxdt, now.t);
  if (!is_finite(now)) return {Status::non_finite, now, 0};

  const auto at = [&](const T& t) {
    State<T> error;
    return advance(stepper, motion, now, T(t - now.t), error);
  };
  const T max_time(solver.max_time);
  const T latest =
      max_time * (T(1) + 4 * std::numeric_limits<T>::epsilon());  // counted steps round
  T h(solver.time_step);
  std::uint64_t steps = 0;
  while (now.t < max_time) {
    if (steps == solver.max_steps) return {Status::step_budget, now, steps};
    Instant<T> next;
    const Trial trial = try_step(stepper, motion, solver, now, ++steps, h, next);
    if (trial == Trial::rejected) continue;
    if (trial == Trial::too_short) return {Status::step_underflow, now, steps};
    if (trial == Trial::non_finite) return {Status::non_finite, now, steps};
    if (solver.release == Release::crossing) {
      const auto release = release_between(stepper, motion, now, next);
      if (release && !is_finite(*release)) return {Status::non_finite, now, steps};
      if (release && release->t <= latest) {
        observe(now, *release, at);
        return {Status::released, *release, steps};
      }
    }
    if (next.t > latest) break;  // a fixed step may end behind the time limit
    observe(now, next, at);
    now = next;
    if (solver.release == Release::window && is_inside_window(now, T(solver.release_window)))
      return {Status::released, now, steps};
  }
  return {Status::not_released, now, steps};
}

}  // namespace trebsweep
