#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/release_rule.hpp"

namespace trebsweep {

/// The fraction of a step after which a function is found to have changed its sign, 0 where it has
/// not, and an estimate of its value there.
template <class T>
struct SignChange {
  T part, value;
};

/// Where phi1 - phi2 has turned back, to a quarter of the step. It may turn again later in the
/// step. The value is its rate, extrapolated linearly, with the sign reversed if that is negative
/// at the start: if the steps are far too long, what interpolation says about rates has no meaning.
template <class T, Effects E>
SignChange<T> turn_of_sling(const Instant<T, E>& from, const Instant<T, E>& to) {
  using std::abs;
  constexpr int parts = 4;
  const T h = to.t - from.t;
  const T v = from.x[w1] - from.x[w2], end_v = to.x[w1] - to.x[w2];
  const T a = h * T(from.dxdt[w1] - from.dxdt[w2]), end_a = h * T(to.dxdt[w1] - to.dxdt[w2]);
  // After a turning point, where the rate is zero, the acceleration has its sign.
  const T sign = select(select(abs(v) > T(0), v, a) < T(0), T(1), T(-1));
  T part = select(sign * end_v > T(0), T(1), T(0));
  for (int i = parts - 1; i > 0; --i) {
    const double s = static_cast<double>(i) / parts, r = 1 - s;
    // Cubic Hermite interpolation of the rate.
    const T rate = T(r * r * (1 + 2 * s)) * v + T(s * s * (1 + 2 * r)) * end_v + T(s * r * r) * a -
                   T(s * s * r) * end_a;
    part = select(sign * rate > T(0), T(s), part);
  }
  return {part, T(sign * T(v + part * a))};
}

/// The turning points and the lift-off from which a swing restarts: the lift-off from the trough;
/// where the rule of release depends on phi1 - phi2, the turning points of that angle; where dry
/// friction holds an arm that turns back, the turning points of the arm.
template <class T, Effects E>
class Turns {
 public:
  Turns(const Scene& scene, const Solver& solver, const AnyStepper<T, E>& stepper)
      : stepper_(stepper),
        rule_(solver),
        tolerance_(solver.tolerance),
        stops_(E.pivot && scene.pivot_friction > 0),
        exist_(E.trough || rule_.is_of_sling() || (stops_ && stepper_.adaptive)) {}

  /// The lanes whose step contains one. A projectile lifts off where it would have to be pulled
  /// into the trough at the end of one of the step's parts, where the motion is interpolated: a
  /// shorter lack of force is not seen.
  LaneMask find(const Motion<T, E>& motion, const Instant<T, E>& from,
                const Instant<T, E>& to) const {
    if (!exist_) return 0;
    LaneMask found = 0;
    if (E.trough || rule_.is_of_sling())
      found = lanes_of(turn_or_lift_off(motion, from, to).part > T(0));
    if (stops_ && stepper_.adaptive) found |= lanes_of(arm_turns(motion, from, to));
    return found;
  }

  /// Makes the first event of each lane the end of its step. Returns 1 in the lanes where it is the
  /// lift-off, else 0.
  ///
  /// As accelerations are continuous, an error of the lift-off's time changes the swing by its
  /// square only, as does one of a turning point the angle there: root finding stops within
  /// sqrt(eps) of the root (as a fraction of the step) or, if that is less, 100 times the tolerance
  /// of the steps.
  T locate(const Motion<T, E>& motion, const Instant<T, E>& from, Instant<T, E>& to) const {
    T lifts_off(0);
    if (E.trough || rule_.is_of_sling()) {
      const SignChange<T> change = turn_or_lift_off(motion, from, to);
      const auto changes = change.part > T(0);
      if (any(changes)) locate_turn_or_lift_off(change, motion, from, to);
      lifts_off = select(changes & (motion.sliding() > T(0)), T(1), T(0));
    }
    const T stops = stopping(motion, from, to);
    locate_turn_of_arm(stops, motion, from, to);
    stop(stops, motion, to);
    return lifts_off;
  }

  /// The lanes whose arm, which turns back within a step of fixed length, stops at its end.
  LaneMask stop_after(const Motion<T, E>& motion, const Instant<T, E>& from,
                      const Instant<T, E>& to) const {
    return stops_ && !stepper_.adaptive ? lanes_of(arm_turns(motion, from, to)) : 0;
  }

  /// 1 where dry friction may hold the arm, because it turns back within the step, else 0.
  T stopping(const Motion<T, E>& motion, const Instant<T, E>& from, const Instant<T, E>& to) const {
    return stops_ ? select(arm_turns(motion, from, to), T(1), T(0)) : T(0);
  }

  /// Continues from rest in the lanes that stop, so that dry friction decides whether they move.
  void stop(const T& stops, const Motion<T, E>& motion, Instant<T, E>& at) const {
    const auto rests = stops > T(0);
    at.x[w1] = select(rests, T(0), at.x[w1]);
    // In the trough, an arm at rest holds the sling.
    if constexpr (E.trough) at.x[w2] = select(rests & (motion.sliding() > T(0)), T(0), at.x[w2]);
    motion.rates(at.x, at.directions, at.dxdt);
  }

  /// Ends the sliding in the lanes that lift off.
  void lift_off(const T& lifts_off, Motion<T, E>& motion, Instant<T, E>& at) const {
    if constexpr (E.trough) {
      motion.set_sliding(select(lifts_off > T(0), T(0), motion.sliding()));
      motion.rates(at.x, at.directions, at.dxdt);
    }
  }

 private:
  using Number = typename Lanes<T>::Number;

  SignChange<T> turn_or_lift_off(const Motion<T, E>& motion, const Instant<T, E>& from,
                                 const Instant<T, E>& to) const {
    SignChange<T> change{T(0), T(0)};
    if (rule_.is_of_sling()) change = turn_of_sling(from, to);
    // An arm that stops at the end of the step changes the rate of phi1 - phi2 there.
    if (stops_ && !stepper_.adaptive)
      change.part = select(arm_turns(motion, from, to), T(0), change.part);
    if constexpr (E.trough) {
      const auto slides = motion.sliding() > T(0);
      if (any(slides)) {
        const SignChange<T> lift_off = find_lift_off(motion, from, to);
        change = {select(slides, lift_off.part, change.part),
                  select(slides, lift_off.value, change.value)};
      }
    }
    return change;
  }

  /// The value is the force that is lacking.
  SignChange<T> find_lift_off(const Motion<T, E>& motion, const Instant<T, E>& from,
                              const Instant<T, E>& to) const {
    const int parts = parts_to_search(stepper_);
    const Quintic<T, E> between(from, to, step_between(from, to));
    const T end = T(-motion.normal_force(to.x, to.directions));
    SignChange<T> change{select(end >= T(0), T(1), T(0)), end};
    for (int i = parts - 1; i > 0; --i) {
      const State<T, E> x = between(static_cast<double>(i) / parts);
      const T lack = T(-motion.normal_force(x, directions<E>(x)));
      const auto lifts_off = lack >= T(0);
      change = {select(lifts_off, T(static_cast<double>(i) / parts), change.part),
                select(lifts_off, lack, change.value)};
    }
    return change;
  }

  void locate_turn_or_lift_off(const SignChange<T>& change, const Motion<T, E>& motion,
                               const Instant<T, E>& from, Instant<T, E>& to) const {
    using std::abs;
    const auto rate = [](const Instant<T, E>& at) { return T(at.x[w1] - at.x[w2]); };
    const T bend = from.dxdt[w1] - from.dxdt[w2];
    const T sign = select(select(abs(rate(from)) > T(0), rate(from), bend) < T(0), T(1), T(-1));
    const auto changes = change.part > T(0), slides = motion.sliding() > T(0);
    const auto value = [&](const Instant<T, E>& at) {
      T turned = sign * rate(at);
      if constexpr (E.trough)
        turned = select(slides, T(-motion.normal_force(at.x, at.directions)), turned);
      return select(changes, turned, T(0));
    };
    const Instant<T, E> at =
        locate_within(select(changes, change.part, T(1)), change.value, value, motion, from, to);
    copy_where<T>(changes, to, at);
    // Without a rate, the next step does not turn at its start again.
    const T scale = T(1e3 * epsilon_) * T(abs(to.x[w1]) + abs(to.x[w2]));
    const auto turns = changes & !slides & (abs(rate(to)) <= scale);
    to.x[w2] = select(turns, to.x[w1], to.x[w2]);
  }

  /// Where the arm turns back, and would stop. A projectile that slides through below the arm's tip
  /// turns the arm back without a stop.
  auto arm_turns(const Motion<T, E>& motion, const Instant<T, E>& from,
                 const Instant<T, E>& to) const {
    const auto turns = T(from.x[w1] * to.x[w1]) < T(0);
    if constexpr (E.trough)
      return turns & !((motion.sliding() > T(0)) & (T(from.x[w2] * to.x[w2]) > T(0)));
    else
      return turns;
  }

  /// Of arms that stop, by an adaptive method, and of those that pass the angle of release and turn
  /// back.
  void locate_turn_of_arm(const T& stops, const Motion<T, E>& motion, const Instant<T, E>& from,
                          Instant<T, E>& to) const {
    const auto passes = rule_.may_turn_beyond(from, to) & !(motion.sliding() > T(0));
    const auto rests = T(stepper_.adaptive ? stops : T(0)) > T(0);
    const auto turns = passes | rests;
    if (!any(turns)) return;
    const T sign = select(from.x[w1] < T(0), T(1), T(-1));
    const auto value = [&](const Instant<T, E>& at) {
      return select(turns, T(sign * at.x[w1]), T(0));
    };
    const Instant<T, E> at = locate_within(T(1), T(sign * to.x[w1]), value, motion, from, to);
    copy_where<T>(rests | (passes & rule_.reached(at)), to, at);
  }

  /// Locates the root of value(instant) before a fraction of the step, at which it is `end`.
  template <class F>
  Instant<T, E> locate_within(const T& part, const T& end, F value, const Motion<T, E>& motion,
                              const Instant<T, E>& from, const Instant<T, E>& to) const {
    using std::abs;
    const T start = value(from), slope = T(abs(T(end - start))) / part;
    const Bracket<T, E> bracket{from, step_between(from, to), T(0), part, T(-start / slope), slope};
    return locate_by_secants(bracket, stepper_, motion, value,
                             T(std::min(std::sqrt(epsilon_), 100 * tolerance_)));
  }

  const AnyStepper<T, E>& stepper_;
  const double epsilon_ =
      static_cast<double>(std::numeric_limits<typename Lanes<T>::Number>::epsilon());
  const ReleaseRule<Number> rule_;
  const double tolerance_;
  const bool stops_, exist_;
};

}  // namespace trebsweep
