#pragma once

#include <cmath>
#include <limits>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// Whether all terms of a sum were finite; finite terms must not be large enough to overflow.
template <class T>
auto is_finite_sum(const T& sum) {
  return T(sum - sum) <= T(0);  // NaN for infinity and NaN
}

/// The error of a step and the error that the tolerance allows, by the norm of Odeint's
/// default_error_checker. A step is accepted if error <= allowed.
template <class T>
struct ErrorRatio {
  T error, allowed;
};

/// The largest ratio of error to allowed error over all coordinates. NaN if the state, its rate or
/// the error is not finite, so that the step is rejected; Odeint's own check would accept NaN.
template <class T, Effects E>
[[gnu::always_inline]] inline ErrorRatio<T> error_ratio(const Instant<T, E>& from,
                                                        const Instant<T, E>& to,
                                                        const State<T, E>& error,
                                                        const std::type_identity_t<T>& h,
                                                        double tolerance) {
  using std::abs;
  using Number = typename Lanes<T>::Number;
  const auto ratio = [&](std::size_t i) {
    return ErrorRatio<T>{abs(error[i]), h * abs(from.dxdt[i]) + T(T(1) + abs(from.x[i]))};
  };
  // Compares over a common denominator, because a division is the most expensive operation.
  const auto larger = [](const ErrorRatio<T>& a, const ErrorRatio<T>& b) {
    const T p = a.error * b.allowed, q = b.error * a.allowed;
    return ErrorRatio<T>{select(p < q, q, p), a.allowed * b.allowed};
  };
  ErrorRatio<T> largest = larger(larger(ratio(phi1), ratio(phi2)), larger(ratio(w1), ratio(w2)));
  if constexpr (coordinates<E> == 6)
    largest = larger(largest, larger(ratio(length), ratio(stretching)));
  T sum = 0;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < coordinates<E>; ++i) sum += T(T(to.x[i] + to.dxdt[i]) + error[i]);
  const T nan = std::numeric_limits<Number>::quiet_NaN();
  return {select(is_finite_sum(sum), largest.error, nan), T(tolerance) * largest.allowed};
}

/// The factor for the next step length: safety factor times (allowed / error)^(1 / (q + 1)), q the
/// order of the error estimate, limited to [1/5, 5] (Hairer, Norsett and Wanner, Solving Ordinary
/// Differential Equations I, II.4). The safety factors 0.9 and 0.8 are among those
/// recommended there.
template <class T>
[[gnu::always_inline]] inline T step_factor(const ErrorRatio<T>& ratio, int error_order) {
  const T factor = T(error_order < 6 ? 0.9 : 0.8) *
                   rough_power(ratio.error, ratio.allowed, -1.0 / (error_order + 1));
  const T low = 0.2, high = 5;
  // NaN, after a step that was not finite, gives the lower limit.
  return select(factor > low, select(factor < high, factor, high), low);
}

/// The outcome of a step, per lane: whether it is accepted, and the length of the next step.
template <class T>
struct Trial {
  decltype(T() <= T()) accepted;
  T next;
};

}  // namespace trebsweep
