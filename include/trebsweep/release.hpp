#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>
#include <optional>

#include "trebsweep/stepper.hpp"

namespace trebsweep {

/// A function's value and slope at one place.
template <class T>
struct ValueAndSlope {
  T value, slope;
};

/// Where an increasing f vanishes between `low` and `high` (f(low) < 0 <= f(high)): Newton's
/// method, with bisection wherever it would leave the bracket. Ends at the first place with |f| <=
/// precision, which is the last one f was asked for; after 100 places, at the last of them.
template <class T, class F>
void find_root(F f, T low, T high, T guess, const T& precision) {
  using std::abs;
  for (int i = 0; i < 100; ++i) {
    const auto [value, slope] = f(guess);
    if (abs(value) <= precision) return;
    (value < T(0) ? low : high) = guess;
    guess -= value / slope;
    if (!(low < guess && guess < high)) guess = (low + high) / T(2);
  }
}

/// The moment of the step from `from` to `to` at which phi1 = pi for the first time, if there is
/// one: the stepper's own step from `from`, of just the length that meets pi to rounding.
template <class Stepper, class T>
std::optional<Instant<T>> release_between(Stepper& stepper, const Motion<T>& motion,
                                          const Instant<T>& from, const Instant<T>& to) {
  const T pi = boost::math::constants::pi<T>();
  if (from.x[phi1] >= pi)
    return std::nullopt;  // beyond it already, or at rest there from the start
  const T precision = 8 * std::numeric_limits<T>::epsilon();
  const T h = to.t - from.t;
  Instant<T> at = to;
  const auto after = [&](const T& theta) {
    State<T> error;
    at = advance(stepper, motion, from, T(theta * h), error);
  };

  T last = 1;
  if (at.x[phi1] < pi) {
    // The arm may have passed pi and come back within the step: look at its turning point.
    if (!(from.x[w1] > T(0) && to.x[w1] < T(0))) return std::nullopt;
    const auto slowing = [&](const T& theta) {
      after(theta);
      last = theta;
      return ValueAndSlope<T>{-at.x[w1], -h * at.dxdt[w1]};
    };
    find_root(slowing, T(0), T(1), T(from.x[w1] / (from.x[w1] - to.x[w1])), precision);
    if (at.x[phi1] < pi) return std::nullopt;
  }
  const auto distance = [&](const T& theta) {
    after(theta);
    return ValueAndSlope<T>{at.x[phi1] - pi, h * at.x[w1]};
  };
  const T chord = last * (pi - from.x[phi1]) / (at.x[phi1] - from.x[phi1]);
  find_root(distance, T(0), last, chord, precision);
  return at;
}

}  // namespace trebsweep
