#pragma once

#include <array>
#include <limits>
#include <utility>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/swing/fallen_angles.hpp"
#include "trebsweep/swing/swing_record.hpp"
#include "trebsweep/swing/worth.hpp"

namespace trebsweep {

/// What is zero at the moment that a bracket holds, while phi1 - phi2 falls from `high` to `low`
/// (rad): the rate of the worth, the clearance or, if these are equal, the distance from them.
template <class T>
struct Root {
  T of_clearance;  ///< 0: of the rate; 1 or, if the clearance rises, -1
  T high, low;
};

/// The best moment of a swing so far.
template <class T, Effects E>
struct BestMoment {
  T worth = -std::numeric_limits<double>::infinity();  ///< an estimate
  Bracket<T, E> bracket;                               ///< the part of a step that holds it
  Root<T> root;
  SwingRecord<T> record;  ///< up to the start of the step
};

/// Makes `candidate` the best moment in the lanes where it is better.
template <class T, Effects E>
void improve(BestMoment<T, E>& best, const BestMoment<T, E>& candidate) {
  const auto is_better = candidate.worth > best.worth;
  if (any(is_better)) copy_where<T>(is_better, best, candidate);
}

/// The margin by which a pin's angle is inside a part of a fall, rad: above rounding errors.
inline constexpr double angle_margin = 1e-13;

/// phi1 - phi2, rad.
template <class X>
auto pin_angle_of(const X& x) {
  using Number = std::remove_cvref_t<decltype(x[phi1])>;
  return Number(x[phi1] - x[phi2]);
}

/// The fraction of a step at which the interpolated phi1 - phi2, which falls, has a value.
template <class T, Effects E>
T fraction_at(const Quintic<T, E>& between, const T& angle) {
  T low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const T middle = T(0.5) * T(low + high);
    const auto is_above = pin_angle_of(between(middle)) > angle;
    low = select(is_above, middle, low);
    high = select(is_above, high, middle);
  }
  return high;
}

/// A part of a fall of phi1 - phi2 within a step: from the angle `enter` down to `leave` (rad);
/// none in the lanes where they are equal.
template <class T>
struct PartOfFall {
  T enter, leave;
};

/// Makes the best moment of a part of a fall within a step the best moment in the lanes where it is
/// better. `h` (s), the length of the step, must not be zero.
template <class T, Effects E>
[[gnu::noinline]] void try_fall(BestMoment<T, E>& best, Release rule, const Motion<T, E>& motion,
                                const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                                const Instant<T, E>& to, const T& h, const PartOfFall<T>& part,
                                const SwingRecord<T>& record) {
  using std::abs;
  using std::sqrt;
  constexpr std::size_t parts = parts_of_fall;
  constexpr double tolerance = 1e-8;
  const T error_of_estimate(0.01);
  const T none = -std::numeric_limits<double>::infinity(), zero(0), one(1);
  const auto& [enter, leave] = part;
  const auto exists = T(enter - leave) > T(4 * angle_margin);
  const auto enters_later = exists & (enter < pin_angle_of(from.x));
  const auto leaves_earlier = exists & (leave > pin_angle_of(to.x));
  const Quintic<T, E> between(from, to, h);
  T begin = zero, end = one;
  if (any(enters_later)) begin = select(enters_later, fraction_at(between, enter), zero);
  if (any(leaves_earlier)) end = select(leaves_earlier, fraction_at(between, leave), one);

  Nodes<T> fractions;
  std::array<Instant<T, E>, parts + 1> at;
  for (std::size_t i = 0; i <= parts; ++i) {
    const T s = begin + T(static_cast<double>(i) / parts) * T(end - begin);
    fractions[i] = s;
    if (i == 0 || i == parts) {
      at[i] = i == 0 ? from : to;
      const auto inside = i == 0 ? enters_later : leaves_earlier;
      if (any(inside)) copy_where<T>(inside, at[i], instant(motion, zero, between(s)));
    } else {
      at[i] = instant(motion, zero, between(s));
    }
  }
  const T highest = enter - T(angle_margin), lowest = leave + T(angle_margin);
  const auto worths = worths_of_fall(rule, mechanism, at, exists, best.worth);

  for (std::size_t i = 1; i <= parts; ++i) {
    const Worth<T>&last = worths[i - 1], &next = worths[i];
    const auto peaks = (last.slope > zero) & (next.slope <= zero);
    const auto sinks = (last.slope > zero) & (next.clearance < zero);
    const auto rises = (last.clearance < zero) & (next.slope <= zero);
    const auto at_ground = sinks | rises;
    // Both the rate of the worth and the clearance change nearly linearly.
    const T start = select(at_ground, last.clearance, last.slope);
    const T fall = start - select(at_ground, next.clearance, next.slope);
    const T low = fractions[i - 1], length = fractions[i] - low;
    const T there = start / fall, mean = select(sinks, last.slope, T(T(0.5) * last.slope));
    const T peak = larger(T(last.value + length * h * mean * there), next.value);
    const auto holds = exists & (peaks | sinks | rises);
    T value = select(holds, select(rises, next.value, peak), none);
    T guess = low + length * there;
    const auto may_win = holds & (T(value + error_of_estimate * abs(value)) > best.worth);
    if (any(may_win)) {
      // Estimates would not tell which of nearly equal moments is better: a step of Newton's
      // method.
      const T near = select(may_win, guess, low);
      const auto closer = worth(rule, mechanism, instant(motion, zero, between(near)), tolerance);
      const T rest = length / fall * select(at_ground, closer.clearance, closer.slope);
      const T gain = select(at_ground, one, T(0.5)) * h * rest * closer.slope;
      const T root = near + rest, better = closer.value + gain;  // NaN below the ground
      const auto known = may_win & (root >= low) & (root <= T(low + length)) & (better > none);
      value = select(known, better, value);
      guess = select(known, root, guess);
    }
    improve(best, {value,
                   {from, h, low, low + length, guess, abs(T(fall / length))},
                   {select(sinks, one, select(rises, T(-1), zero)), highest, lowest},
                   record});
  }

  // The ends of the part, where a pin's angle is just inside.
  const auto try_end = [&](std::size_t node, const T& direction, const T& angle) {
    // The time in which the angle changes by the margin, also from a turning point.
    const T rate = abs(T(at[node].x[w1] - at[node].x[w2]));
    const T bend = abs(T(at[node].dxdt[w1] - at[node].dxdt[w2]));
    const T speed = sqrt(T(rate * rate + T(2 * angle_margin) * bend));
    const T time = T(2 * angle_margin) / T(rate + speed);
    improve(best, {select(exists, worths[node].value, none),
                   {from, h, zero, one, T(fractions[node] + direction * time / h), T(speed * h)},
                   {zero, angle, angle},
                   record});
  };
  try_end(0, one, highest);
  try_end(parts, T(-1), lowest);
}

/// The search for the best release of the swing in every lane.
template <class T, Effects E>
class BestRelease {
 public:
  const BestMoment<T, E>& moment() const { return best_; }

  void reset(std::size_t lane) {
    copy_lane<T>(best_, lane, BestMoment<T, E>{}, 0);
    fallen_[lane].clear();
  }

  void copy(std::size_t lane, const BestRelease& other, std::size_t other_lane) {
    copy_lane<T>(best_, lane, other.best_, other_lane);
    fallen_[lane] = other.fallen_[other_lane];
  }

  /// Searches a step of length h (s) in some lanes, where phi1 - phi2 does not turn back.
  void try_step(LaneMask mask, Release rule, const Motion<T, E>& motion,
                const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                const Instant<T, E>& to, const T& h, const SwingRecord<T>& record) {
    const T high = pin_angle_of(from.x), low = pin_angle_of(to.x);
    const LaneMask falling = mask & lanes_of(low < high);
    T top = high;
    for (LaneMask left = falling; left != 0;) {
      PartOfFall<T> part{high, high};
      for (LaneMask lanes = left; lanes != 0; lanes &= lanes - 1) {
        const std::size_t lane = first_lane(lanes);
        const auto next = fallen_[lane].new_part(get_lane(top, lane), get_lane(low, lane));
        if (next) {
          set_lane(part.enter, lane, next->high);
          set_lane(part.leave, lane, next->low);
          set_lane(top, lane, next->low);
        } else {
          left &= ~(LaneMask{1} << lane);
        }
      }
      if (left != 0) try_fall(best_, rule, motion, mechanism, from, to, h, part, record);
    }
    for (LaneMask lanes = falling; lanes != 0; lanes &= lanes - 1) {
      const std::size_t lane = first_lane(lanes);
      fallen_[lane].add(get_lane(high, lane), get_lane(low, lane));
    }
  }

 private:
  BestMoment<T, E> best_{};
  std::array<FallenAngles<typename Lanes<T>::Number>, Lanes<T>::count> fallen_;
};

/// The instant of the best moment, located by the stepper, or the end of its part of a fall where
/// it lies beyond, since parts are searched with an interpolated motion. Flights through air are
/// integrated with a relative error of about `tolerance`, or that of flight(), if that is larger.
template <class T, Effects E>
Instant<T, E> best_instant(const BestMoment<T, E>& best, Release rule, double tolerance,
                           const AnyStepper<T, E>& stepper, const Motion<T, E>& motion,
                           const Mechanism<T, E>& mechanism) {
  using Number = typename Lanes<T>::Number;
  const double epsilon = static_cast<double>(std::numeric_limits<Number>::epsilon());
  const auto exists = best.worth > T(-std::numeric_limits<double>::infinity());
  const Root<T>& root = best.root;
  const auto of_worth = exists & (root.high > root.low);
  const bool any_of_worth = any(of_worth);
  // The ends of a part come from interpolation: the root may lie slightly beyond them.
  Bracket<T, E> bracket = best.bracket;
  bracket.low = select(bracket.low > T(0.01), T(bracket.low - T(0.01)), T(0));
  bracket.high = select(bracket.high < T(0.99), T(bracket.high + T(0.01)), T(1));
  const auto falling = [&](const Instant<T, E>& at) {
    const T distance = select(exists, T(root.high - pin_angle_of(at.x)), T(0));
    if (!any_of_worth) return distance;
    constexpr double margin = 1e-9;  // m: on the ground, rounding errors would decide
    const auto [value, slope, clearance] =
        worth(rule, mechanism, at, std::max({tolerance, 450 * epsilon, 1e-17}));
    const T above = select(root.of_clearance * root.of_clearance > T(0),
                           T(root.of_clearance * T(clearance - T(margin))), slope);
    return select(of_worth, T(-above), distance);
  };
  const T precision = std::sqrt(epsilon) / 100;
  Instant<T, E> at = locate_by_secants(bracket, stepper, motion, falling, precision);

  const T angle = pin_angle_of(at.x);
  const auto outside = of_worth & ((angle > root.high) | (angle < root.low));
  if (any(outside)) {
    const T end = select(angle > root.high, root.high, root.low);
    const auto beyond = [&](const Instant<T, E>& instant) {
      return select(outside, T(end - pin_angle_of(instant.x)), T(0));
    };
    using std::abs;
    const auto& [from, h, first, last, guess, slope] = best.bracket;
    const T rate = abs(T(at.x[w1] - at.x[w2]));
    const Bracket<T, E> whole{from, h, T(0), T(1), guess, T(rate * h)};
    copy_where<T>(outside, at, locate_by_secants(whole, stepper, motion, beyond, precision));
  }
  return at;
}

}  // namespace trebsweep
