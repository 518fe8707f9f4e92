#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// A function's value and slope at one place.
template <class T>
struct ValueAndSlope {
  T value, slope;
};

/// Where an increasing f vanishes between `low` and `high` (f(low) < 0 <= f(high)), in every lane:
/// Newton's method, with bisection wherever it would leave the bracket. Ends with the last place
/// that f was asked for, which Newton's method would change by no more than `precision`, or where
/// |f| is of the size of roundings; after 100 places at the latest. A lane stays at its place once
/// it is there, whatever the others do.
template <class T, class F>
void find_root(F f, T low, T high, T guess, const T& precision) {
  using std::abs;
  const T rounding = 8 * std::numeric_limits<typename Lanes<T>::Number>::epsilon();
  const auto inside = [&] { return (low < guess) & (guess < high); };
  guess = select(inside(), guess, T((low + high) / T(2)));
  for (int i = 0; i < 100; ++i) {
    const auto [value, slope] = f(guess);
    const auto found = (abs(value) <= T(precision * slope)) | (abs(value) <= rounding);
    if (!any(!found)) return;
    const auto below = value < T(0);
    low = select(below & !found, guess, low);
    high = select(below | found, high, guess);
    const T here = guess;
    guess = here - value / slope;
    guess = select(inside(), guess, T((low + high) / T(2)));
    guess = select(found, here, guess);
  }
}

/// The part of a step from `from` to `to` after which phi1 = pi, by the quintic Hermite
/// interpolation of the time over phi1; a guess.
template <class T, Effects E>
T guess_release(const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  const T pi = boost::math::constants::pi<typename Lanes<T>::Number>();
  const T turn = to.x[phi1] - from.x[phi1];
  // Slope and curvature at both ends, of step parts over parts of the turn.
  const auto slope = [&](const Instant<T, E>& at) { return T(turn / T(h * at.x[w1])); };
  const auto curvature = [&](const Instant<T, E>& at, const T& m) {
    return T(-at.dxdt[w1] * h * h / turn * m * m * m);
  };
  const T m0 = slope(from), m1 = slope(to);
  const T c0 = curvature(from, m0), c1 = curvature(to, m1);
  const T s = (pi - from.x[phi1]) / turn;
  const T a3 = T(10) - T(6) * m0 - T(4) * m1 - T(1.5) * c0 + T(0.5) * c1;
  const T a4 = T(-15) + T(8) * m0 + T(7) * m1 + T(1.5) * c0 - c1;
  const T a5 = T(6) - T(3) * m0 - T(3) * m1 - T(0.5) * c0 + T(0.5) * c1;
  return s * (m0 + s * (T(0.5) * c0 + s * (a3 + s * (a4 + s * a5))));
}

/// The moment of the step from `from` (phi1 < pi) to `to` (phi1 >= pi) at which phi1 = pi: the
/// stepper's own step from `from`, of just that length.
///
/// `to` may also be a turning point, where w1 = 0. The last part of the way, at most 1e-6 of the
/// step, is a straight line: its error is 1e-12 of how the step bends.
template <class Stepper, class T, Effects E>
Instant<T, E> release_between(Stepper& stepper, const Motion<T, E>& motion,
                              const Instant<T, E>& from, const Instant<T, E>& to) {
  using std::abs;
  using std::sqrt;
  using Number = typename Lanes<T>::Number;
  const T pi = boost::math::constants::pi<Number>();
  const T h = to.t - from.t;
  const T precision = T(sqrt(T(4500 * std::numeric_limits<Number>::epsilon())));
  Instant<T, E> at;
  State<T, E> error;
  const auto distance = [&](const T& part) {
    advance(stepper, motion, from, T(part * h), at, error);
    return ValueAndSlope<T>{at.x[phi1] - pi, h * at.x[w1]};
  };
  find_root(distance, T(0), T(1), guess_release(from, to, h), precision);
  const T rest = pi - at.x[phi1];
  const auto is_near = abs(rest) <= T(precision * h * at.x[w1]);
  const T dt = select(is_near, T(rest / at.x[w1]), T(0));
  at.t = at.t + dt;
  for (std::size_t i = 0; i < at.x.size(); ++i) at.x[i] = at.x[i] + dt * at.dxdt[i];
  return at;
}

/// The moment of the step from `from` to `to` at which the arm turns back: w1 changes its sign.
template <class Stepper, class T, Effects E>
Instant<T, E> turn_between(Stepper& stepper, const Motion<T, E>& motion, const Instant<T, E>& from,
                           const Instant<T, E>& to) {
  using Number = typename Lanes<T>::Number;
  const T h = to.t - from.t;
  Instant<T, E> at;
  State<T, E> error;
  const T sign = select(from.x[w1] > T(0), T(-1), T(1));  // find_root wants it to increase
  const auto slowing = [&](const T& part) {
    advance(stepper, motion, from, T(part * h), at, error);
    return ValueAndSlope<T>{sign * at.x[w1], T(sign * h) * at.dxdt[w1]};
  };
  find_root(slowing, T(0), T(1), T(from.x[w1] / T(from.x[w1] - to.x[w1])),
            T(8 * std::numeric_limits<Number>::epsilon()));
  return at;
}

}  // namespace trebsweep
