#pragma once

#include <cmath>
#include <limits>

#include "trebsweep/ode/root_finding.hpp"
#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// An angle that ends a swing when it rises to a value: phi1, or phi2 - phi1 for a pin, from which
/// the sling slips when phi1 - phi2 has fallen to the pin's angle.
template <class Number>
struct AngleEvent {
  bool of_sling;
  Number target;  ///< rad

  template <class X>
  auto value(const X& x) const {
    return combined(x[phi1], x[phi2]);
  }
  template <class X>
  auto rate(const X& x) const {
    return combined(x[w1], x[w2]);
  }

 private:
  template <class T>
  T combined(const T& arm, const T& sling) const {
    return of_sling ? T(sling - arm) : arm;
  }
};

/// An estimate of the fraction of the step from `from` to `to` at which the angle has its target:
/// quintic Hermite interpolation of the time as a function of the angle.
template <class Number, class T, Effects E>
T guess_event(const AngleEvent<Number>& event, const Instant<T, E>& from, const Instant<T, E>& to,
              const T& h) {
  const T turn = event.value(to.x) - event.value(from.x);
  // First and second derivatives at both ends, both variables scaled to [0, 1].
  const auto slope = [&](const Instant<T, E>& at) { return T(turn / T(h * event.rate(at.x))); };
  const auto curvature = [&](const Instant<T, E>& at, const T& m) {
    return T(-event.rate(at.dxdt) * h * h / turn * m * m * m);
  };
  const T m0 = slope(from), m1 = slope(to);
  const T c0 = curvature(from, m0), c1 = curvature(to, m1);
  const T s = (T(event.target) - event.value(from.x)) / turn;
  const T a3 = T(10) - T(6) * m0 - T(4) * m1 - T(1.5) * c0 + T(0.5) * c1;
  const T a4 = T(-15) + T(8) * m0 + T(7) * m1 + T(1.5) * c0 - c1;
  const T a5 = T(6) - T(3) * m0 - T(3) * m1 - T(0.5) * c0 + T(0.5) * c1;
  return s * (m0 + s * (T(0.5) * c0 + s * (a3 + s * (a4 + s * a5))));
}

/// A step of length h from `from`, and the fractions of it between which a function of the instant
/// rises from below zero.
template <class T, Effects E>
struct Bracket {
  Instant<T, E> from;
  T h;          ///< s; not zero
  T low, high;  ///< 0 and 1: the ends of the step
  T guess;      ///< of the root
  T slope;      ///< an estimate of the function's derivative with respect to the fraction
};

/// Locates the root of a function: the instant that the stepper itself reaches from the start of
/// the step with a step of the right length. f(part, at) is the function's value at an instant, and
/// its derivative with respect to the fraction of the step, which `part` is. Root finding stops
/// within `precision` of the root, as a fraction of the step; the rest is extrapolated linearly,
/// with an error of the order of its square.
template <class Stepper, class T, Effects E, class F>
Instant<T, E> locate(const Bracket<T, E>& bracket, Stepper& stepper, const Motion<T, E>& motion,
                     F f, const T& precision) {
  using std::abs;
  Instant<T, E> at;
  State<T, E> error;
  ValueAndSlope<T> last;
  const auto value_and_slope = [&](const T& part) {
    advance(stepper, motion, bracket.from, T(part * bracket.h), at, error);
    return last = f(part, at);
  };
  find_root(value_and_slope, bracket.low, bracket.high, bracket.guess, precision);
  const auto is_near = abs(last.value) <= T(precision * last.slope);
  const T dt = select(is_near, T(T(-last.value / last.slope) * bracket.h), T(0));
  for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] = at.x[i] + dt * at.dxdt[i];
  return instant(motion, at.t + dt, at.x);
}

/// The same for f(at), whose derivative is not known: slopes are those of secants, the first one
/// that of the bracket.
template <class Stepper, class T, Effects E, class F>
Instant<T, E> locate_by_secants(const Bracket<T, E>& bracket, Stepper& stepper,
                                const Motion<T, E>& motion, F f, const T& precision) {
  using std::abs;
  T last_part = bracket.guess, last_value = T(0), slope = bracket.slope;
  const auto with_slope = [&](const T& part, const Instant<T, E>& at) {
    const T value = f(at), distance = part - last_part;
    // Rounding errors would spoil the slope of a shorter secant.
    const auto moved = abs(distance) > T(1e-6);
    slope = select(moved, T(T(value - last_value) / select(moved, distance, T(1))), slope);
    last_part = part;
    last_value = value;
    return ValueAndSlope<T>{value, slope};
  };
  return locate(bracket, stepper, motion, with_slope, precision);
}

/// Locates the event within the step from `from`, where the angle is below its target, to `to`,
/// where it is not, with an error of 1e-12 of the step. `to` may be a turning point, where the
/// angle has no rate.
template <class Number, class Stepper, class T, Effects E>
Instant<T, E> event_between(const AngleEvent<Number>& event, Stepper& stepper,
                            const Motion<T, E>& motion, const Instant<T, E>& from,
                            const Instant<T, E>& to) {
  using std::sqrt;
  const T h = to.t - from.t;
  const auto distance = [&](const T&, const Instant<T, E>& at) {
    return ValueAndSlope<T>{event.value(at.x) - T(event.target), h * event.rate(at.x)};
  };
  const T guess = guess_event(event, from, to, h);
  const Bracket<T, E> bracket{from, h, T(0), T(1), guess, T(1)};
  return locate(bracket, stepper, motion, distance,
                T(sqrt(T(4500 * std::numeric_limits<Number>::epsilon()))));
}

}  // namespace trebsweep
