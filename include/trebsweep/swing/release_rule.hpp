#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/swing/lane_state.hpp"

namespace trebsweep {

/// The fraction of a step at which the arm is turning back, a multiple of a quarter; 0 where it
/// does not turn back. It may turn forward again later in the step.
template <class T, Effects E>
T turned_by(const Instant<T, E>& from, const Instant<T, E>& to) {
  constexpr int parts = 4;
  const T h = to.t - from.t;
  const T v = from.x[w1], end_v = to.x[w1], a = h * from.dxdt[w1], end_a = h * to.dxdt[w1];
  T part = select(end_v < T(0), T(1), T(0));
  for (int i = parts - 1; i > 0; --i) {
    const double s = static_cast<double>(i) / parts, r = 1 - s;
    // Cubic Hermite interpolation of the rate.
    const T rate = T(r * r * (1 + 2 * s)) * v + T(s * s * (1 + 2 * r)) * end_v + T(s * r * r) * a -
                   T(s * s * r) * end_a;
    part = select(rate < T(0), T(s), part);
  }
  return select(v > T(0), part, T(0));
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

  /// Whether the release is the best moment of an interval, the end of which ends the swing.
  bool chooses() const { return takes_best_moment(name_); }

  /// The lanes in which the step may contain the event or a turning point of its angle.
  template <class T, Effects E>
  LaneMask possible(const Instant<T, E>& from, const Instant<T, E>& to) const {
    // Negated so that NaN is possible as well.
    const LaneMask passed = lanes_of(!(event_.value(to.x) < T(event_.target)));
    if (is_window()) return passed;
    if (chooses()) return passed | lanes_of(turned_by(from, to) > T(0));
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
    if (passes(lane, from, to)) return true;
    return chooses() &&
           (get_lane(turned_by(from, to), lane) > Number(0) || get_lane(to.t, lane) >= max_time_);
  }

  /// Whether the angle passes its target in a lane. A start beyond it does not.
  template <class T, Effects E>
  bool passes(std::size_t lane, const Instant<T, E>& from, const Instant<T, E>& to) const {
    const auto angle = [&](const Instant<T, E>& at) {
      return event_.value(std::array{get_lane(at.x[phi1], lane), get_lane(at.x[phi2], lane)});
    };
    return angle(to) >= event_.target && angle(from) < event_.target;
  }

  /// Whether the step ends the swing of a lane whose projectile still slides; a pin's angle counts
  /// after the lift-off only.
  template <class T, Effects E>
  bool ends_sliding(std::size_t lane, const Instant<T, E>& from, const Instant<T, E>& to) const {
    return !event_.of_sling && passes(lane, from, to);
  }

  /// Where the angle turns back within a step of the lanes in `mask`, having possibly passed its
  /// target, makes the turning point the end of the step.
  template <class Stepper, class T, Effects E>
  void end_at_turning_points(LaneMask mask, Stepper& stepper, const Motion<T, E>& motion,
                             const Instant<T, E>& from, Instant<T, E>& to) const {
    const T target = event_.target, start = event_.value(from.x);
    const T rate = event_.rate(from.x), end_rate = event_.rate(to.x);
    // An upper bound of the angle within the step.
    const T bound = start + T(to.t - from.t) * T(rate - end_rate);
    mask &= lanes_of((start < target) & (event_.value(to.x) < target) & (bound >= target) &
                     (rate > T(0)) & (end_rate < T(0)));
    if (mask == 0) return;
    const Instant<T, E> turn = turn_between(event_, stepper, motion, from, to);
    for (; mask != 0; mask &= mask - 1) {
      const std::size_t lane = first_lane(mask);
      if (get_lane(event_.value(turn.x), lane) >= event_.target) copy_lane<T>(to, lane, turn, lane);
    }
  }

 private:
  Release name_;
  AngleEvent<Number> event_;
  Number window_, max_time_;
};

}  // namespace trebsweep
