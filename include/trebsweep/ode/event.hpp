#pragma once

#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <limits>

#include "trebsweep/ode/root_finding.hpp"
#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// An estimate of the fraction of the step from `from` to `to` at which phi1 = pi: quintic Hermite
/// interpolation of the time as a function of phi1.
template <class T, Effects E>
T guess_release(const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  const T pi = boost::math::constants::pi<typename Lanes<T>::Number>();
  const T turn = to.x[phi1] - from.x[phi1];
  // First and second derivatives at both ends, both variables scaled to [0, 1].
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

/// Locates the release, phi1 = pi, within the step from `from` (phi1 < pi) to `to` (phi1 >= pi):
/// the instant that the stepper itself reaches from `from` with a step of the right length.
/// `to` may be a turning point, where w1 = 0.
///
/// Root finding stops within 1e-6 of the root (as a fraction of the step, in double precision:
/// sqrt(4500 eps)). The rest is extrapolated linearly, with an error of the order of its square,
/// 1e-12 of the step.
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

/// Locates the turning point of the arm, w1 = 0, within the step from `from` to `to`, over which w1
/// changes its sign.
template <class Stepper, class T, Effects E>
Instant<T, E> turn_between(Stepper& stepper, const Motion<T, E>& motion, const Instant<T, E>& from,
                           const Instant<T, E>& to) {
  using Number = typename Lanes<T>::Number;
  const T h = to.t - from.t;
  Instant<T, E> at;
  State<T, E> error;
  const T sign =
      select(from.x[w1] > T(0), T(-1), T(1));  // find_root() needs an increasing function
  const auto slowing = [&](const T& part) {
    advance(stepper, motion, from, T(part * h), at, error);
    return ValueAndSlope<T>{sign * at.x[w1], T(sign * h) * at.dxdt[w1]};
  };
  find_root(slowing, T(0), T(1), T(from.x[w1] / T(from.x[w1] - to.x[w1])),
            T(8 * std::numeric_limits<Number>::epsilon()));
  return at;
}

}  // namespace trebsweep
