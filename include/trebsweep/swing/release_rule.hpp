#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/swing/lane_state.hpp"

namespace trebsweep {

/// phi1 = 3 pi/2, where a swing whose release depends on the sling's angle ends at the latest.
template <class Number>
AngleEvent<Number> last_arm_event() {
  return {false, boost::math::constants::pi<Number>() * Number(1.5)};
}

/// The event that ends a swing by the rule of release; by the rules farthest and fastest, the end
/// of the search for the best release.
template <class Number>
AngleEvent<Number> end_event(const Solver& solver) {
  const Number pi = boost::math::constants::pi<Number>();
  switch (solver.release) {
    case Release::window:
      return {false, pi - Number(solver.release_window * (1 + 1e-9))};
    case Release::pin:
      return {true, Number(-solver.pin_angle.value())};
    case Release::farthest:
    case Release::fastest:
      return last_arm_event<Number>();
    case Release::crossing:
      break;
  }
  // The default is pi in every number type.
  return {false, solver.release_angle == std::numbers::pi ? pi : Number(solver.release_angle)};
}

/// The rule of release of a solver.
template <class Number>
class ReleaseRule {
 public:
  explicit ReleaseRule(const Solver& solver)
      : name_(solver.release),
        event_(end_event<Number>(solver)),
        window_(solver.release_window),
        max_time_(solver.max_time) {}

  /// The event that ends the swing; for the window, the angle at which it begins.
  const AngleEvent<Number>& event() const { return event_; }

  bool is_window() const { return name_ == Release::window; }

  /// Whether the release is the best of those that a pin can make. The event then ends the search.
  bool chooses() const { return takes_best_moment(name_); }

  /// Whether the release depends on phi1 - phi2. No step may then contain a turning point of this
  /// angle, so that it falls through the same values by every such rule.
  bool is_of_sling() const { return name_ == Release::pin || chooses(); }

  /// The lanes in which the step may contain the event or a turning point of its angle.
  template <class T, Effects E>
  LaneMask possible(const Instant<T, E>& from, const Instant<T, E>& to) const {
    // Negated so that NaN is possible as well.
    LaneMask passed = lanes_of(!(event_.value(to.x) < T(event_.target)));
    if (event_.of_sling) passed |= lanes_of(!(to.x[phi1] < T(last_arm_.target)));
    if (is_window() || event_.of_sling) return passed;
    return passed | lanes_of((event_.rate(from.x) > T(0)) & (event_.rate(to.x) < T(0)));
  }

  /// Whether the step ends the swing of a lane.
  template <class T, Effects E>
  bool ends(std::size_t lane, const Instant<T, E>& from, const Instant<T, E>& to) const {
    using std::abs;
    if (is_window()) {
      const Number pi = boost::math::constants::pi<Number>();
      return abs(Number(pi - get_lane(to.x[phi1], lane))) < window_;
    }
    return passes(event_, lane, from, to) || (chooses() && get_lane(to.t, lane) >= max_time_);
  }

  /// Whether the step ends the swing of a lane without a release: while the projectile still
  /// slides, at the angle of the arm that would release it; by a pin, where the arm has gone too
  /// far.
  template <class T, Effects E>
  bool gives_up(std::size_t lane, bool sliding, const Instant<T, E>& from,
                const Instant<T, E>& to) const {
    if (event_.of_sling) return passes(last_arm_, lane, from, to);
    return sliding && passes(event_, lane, from, to);
  }

  /// Whether a release at an instant of a lane is too late for the arm.
  template <class T, Effects E>
  bool is_beyond(std::size_t lane, const Instant<T, E>& at) const {
    return event_.of_sling && get_lane(at.x[phi1], lane) >= last_arm_.target;
  }

  /// Where the arm turns back within the step, having possibly passed its target.
  template <class T, Effects E>
  auto may_turn_beyond(const Instant<T, E>& from, const Instant<T, E>& to) const {
    const T target = event_.target, start = event_.value(from.x);
    const T rate = event_.rate(from.x), end_rate = event_.rate(to.x);
    // An upper bound of the angle within the step.
    const T bound = start + T(to.t - from.t) * T(rate - end_rate);
    const T ends_below = is_window() || event_.of_sling ? T(-1) : T(target - event_.value(to.x));
    return (start < target) & (ends_below > T(0)) & (bound >= target) & (rate > T(0)) &
           (end_rate < T(0));
  }

  /// Whether the angle of the event has its target at the instant.
  template <class T, Effects E>
  auto reached(const Instant<T, E>& at) const {
    return event_.value(at.x) >= T(event_.target);
  }

 private:
  /// Whether an angle passes its target in a lane. A start beyond it does not.
  template <class T, Effects E>
  static bool passes(const AngleEvent<Number>& event, std::size_t lane, const Instant<T, E>& from,
                     const Instant<T, E>& to) {
    const auto angle = [&](const Instant<T, E>& at) {
      return event.value(std::array{get_lane(at.x[phi1], lane), get_lane(at.x[phi2], lane)});
    };
    return angle(to) >= event.target && angle(from) < event.target;
  }

  Release name_;
  AngleEvent<Number> event_;
  AngleEvent<Number> last_arm_ = last_arm_event<Number>();
  Number window_, max_time_;
};

}  // namespace trebsweep
