#pragma once

#include <limits>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// What a release at a moment of the swing is worth.
template <class T>
struct Worth {
  T value;      ///< the range by the rule farthest, the square of the speed by the rule fastest
  T slope;      ///< its rate along the swing
  T clearance;  ///< m above ground_rounding; below zero, value and slope are NaN
};

template <class T, Effects E>
Worth<T> worth(Release rule, const Mechanism<T, E>& mechanism, const Instant<T, E>& at,
               double tolerance) {
  const Vector<T> velocity = mechanism.velocity(at.x, at.directions);
  const Vector<T> force = mechanism.specific_force(at.x, at.directions, at.dxdt);
  const Scene& scene = mechanism.scene();
  if (rule == Release::farthest) {
    const Vector<T> position = mechanism.projectile(at.x, at.directions);
    // A flight does not change its own impact: only the rest of the acceleration does.
    const auto range = range_and_slope(scene, position, velocity,
                                       force + deceleration(scene, velocity), tolerance);
    return {range.value, range.slope, position.y + T(scene.fulcrum_height + ground_rounding)};
  }
  const Vector<T> acceleration = force + Vector<T>{T(0), T(-scene.gravity)};
  return {dot(velocity, velocity), T(2) * dot(velocity, acceleration), T(1)};
}

/// The best moment of a swing so far.
template <class T, Effects E>
struct BestMoment {
  T worth = -std::numeric_limits<double>::infinity();  ///< an estimate
  /// The part of a step in which the rate of the worth falls through zero, or the projectile
  /// passes the ground; if `low` is `high`, the moment is at the start of the step.
  Bracket<T, E> bracket;
  T at_ground = 0;        ///< of the clearance: 1 if it falls, -1 if it rises
  SwingRecord<T> record;  ///< up to the start of the step
};

/// Makes `candidate` the best moment in the lanes where it is better.
template <class T, Effects E>
void improve(BestMoment<T, E>& best, const BestMoment<T, E>& candidate) {
  copy_where<T>(candidate.worth > best.worth, best, candidate);
}

/// Makes an instant the best moment in the lanes where it is better.
template <class T, Effects E>
void try_instant(BestMoment<T, E>& best, const T& worth, const Instant<T, E>& at,
                 const SwingRecord<T>& record) {
  improve(best, {worth, {at, T(1), T(0), T(0), T(0), T(1)}, T(0), record});
}

/// Makes the best moment within a step the best moment in the lanes where it is better, and where
/// it is the first of the interval, also its start. `h` (s), the length of the step, must not be
/// zero. The motion is interpolated at the ends of `parts` parts.
template <class T, Effects E>
[[gnu::noinline]] void try_step_of_swing(BestMoment<T, E>& best, Release rule, int parts,
                                         const Motion<T, E>& motion,
                                         const Mechanism<T, E>& mechanism,
                                         const Instant<T, E>& from, const Instant<T, E>& to,
                                         const T& h, const SwingRecord<T>& record) {
  using std::abs;
  // Good enough to find the part with the best moment, which is then located.
  constexpr double tolerance = 1e-5;
  const T none = -std::numeric_limits<double>::infinity();
  const Quintic<T, E> between(from, to, h);
  auto last = worth(rule, mechanism, from, tolerance);
  try_instant(best, select(best.worth > none, none, last.value), from, record);
  for (int i = 1; i <= parts; ++i) {
    const Instant<T, E> at =
        i == parts ? to : instant(motion, T(0), between(static_cast<double>(i) / parts));
    const auto next = worth(rule, mechanism, at, tolerance);
    const auto peaks = (last.slope > T(0)) & (next.slope <= T(0));
    const auto sinks = (last.slope > T(0)) & (next.clearance < T(0));
    const auto rises = (last.clearance < T(0)) & (next.slope <= T(0));
    const auto at_ground = sinks | rises;
    // Both the rate of the worth and the clearance change nearly linearly.
    const T start = select(at_ground, last.clearance, last.slope);
    const T fall = start - select(at_ground, next.clearance, next.slope);
    const T part = start / fall, mean = select(sinks, last.slope, T(T(0.5) * last.slope));
    const T low = static_cast<double>(i - 1) / parts, length = 1.0 / parts;
    const T value = last.value + T(1.0 / parts) * h * mean * part;
    improve(best, {select(rises, next.value, select(peaks | sinks, value, none)),
                   {from, h, low, low + length, low + length * part, abs(T(fall * T(parts)))},
                   select(sinks, T(1), select(rises, T(-1), T(0))),
                   record});
    last = next;
  }
}

/// The instant of the best moment, located by the stepper.
template <class Stepper, class T, Effects E>
Instant<T, E> best_instant(const BestMoment<T, E>& best, Release rule, Stepper& stepper,
                           const Motion<T, E>& motion, const Mechanism<T, E>& mechanism) {
  using Number = typename Lanes<T>::Number;
  const double epsilon = static_cast<double>(std::numeric_limits<Number>::epsilon());
  const auto located = best.bracket.low < best.bracket.high;
  // The ends of the part come from interpolation: the root may lie slightly beyond them.
  Bracket<T, E> bracket = best.bracket;
  bracket.low = select(bracket.low > T(0), T(bracket.low - T(0.01)), T(0));
  bracket.high = bracket.high + T(0.01);
  const auto falling = [&](const Instant<T, E>& at) {
    constexpr double margin = 1e-9;  // m: on the ground, rounding errors would decide
    const auto [value, slope, clearance] =
        worth(rule, mechanism, at, std::max(450 * epsilon, 1e-17));
    const T above = select(best.at_ground * best.at_ground > T(0),
                           T(best.at_ground * T(clearance - T(margin))), slope);
    return select(located, T(-above), T(0));
  };
  Instant<T, E> at = root_in(bracket, stepper, motion, falling, std::sqrt(epsilon) / 100);
  copy_where<T>(!located, at, best.bracket.from);
  return at;
}

/// The end of the interval within the last step, from `from` to `to`: the first of phi1 = 3 pi/2,
/// the arm turning back, and max_time. `turned` is that of turned_by().
template <class Stepper, class T, Effects E>
Instant<T, E> end_of_interval(Stepper& stepper, const Motion<T, E>& motion,
                              const Instant<T, E>& from, const Instant<T, E>& to, const T& turned,
                              const T& max_time) {
  using Number = typename Lanes<T>::Number;
  const T h = to.t - from.t, limit = max_time - from.t;
  const T angle = boost::math::constants::pi<Number>() * Number(1.5);
  const auto passes = to.x[phi1] >= angle;
  const auto turns = (turned > T(0)) & !passes;
  const T end = select(limit < h, T(limit / h), T(1));
  Instant<T, E> at;
  State<T, E> error;
  const auto beyond = [&](const T& part) {
    advance(stepper, motion, from, T(part * h), at, error);
    const T late = part - end;
    const T value = select(passes, T(at.x[phi1] - angle), select(turns, T(-at.x[w1]), late));
    const T slope = select(passes, at.x[w1], select(turns, T(-at.dxdt[w1]), T(T(1) / h)));
    const auto limited = value < late;
    return ValueAndSlope<T>{select(limited, late, value), select(limited, T(1), T(h * slope))};
  };
  const T turn = T(0.5) * turned;
  // The end of the step, which is the most frequent root, must be inside the bracket.
  find_root(beyond, T(0), select(turns, turned, T(1.01)),
            select(turns, turn, select(passes, T(0.5), end)),
            T(4500 * std::numeric_limits<Number>::epsilon()));
  return at;
}

}  // namespace trebsweep
