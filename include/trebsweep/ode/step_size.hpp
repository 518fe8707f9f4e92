#pragma once

#include <cmath>
#include <limits>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// Whether a sum of finite numbers, none near the largest, has only such terms.
template <class T>
auto is_finite_sum(const T& sum) {
  return T(sum - sum) <= T(0);  // NaN for infinity and NaN
}

/// A step's error beside what the tolerance allows, in the measure of Odeint's
/// default_error_checker; the step is good where error <= allowed.
template <class T>
struct ErrorRatio {
  T error, allowed;
};

/// The largest error of a step in units of the allowed one. Where the step's end or error is not
/// finite, NaN, so that the step is not good; Odeint's own test lets NaN pass.
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
  // The larger of two ratios over a common denominator: a division is the dearest operation.
  const auto larger = [](const ErrorRatio<T>& a, const ErrorRatio<T>& b) {
    const T p = a.error * b.allowed, q = b.error * a.allowed;
    return ErrorRatio<T>{select(p < q, q, p), a.allowed * b.allowed};
  };
  ErrorRatio<T> largest = larger(larger(ratio(phi1), ratio(phi2)), larger(ratio(w1), ratio(w2)));
  if constexpr (E.elastic) largest = larger(largest, larger(ratio(length), ratio(stretching)));
  T sum = 0;
  for (std::size_t i = 0; i < coordinates<E>; ++i) sum += T(T(to.x[i] + to.dxdt[i]) + error[i]);
  const T nan = std::numeric_limits<Number>::quiet_NaN();
  return {select(is_finite_sum(sum), largest.error, nan), T(tolerance) * largest.allowed};
}

/// By how much to change the step after an ErrorRatio: the usual law (Hairer, Norsett and Wanner,
/// Solving Ordinary Differential Equations I, II.4), between a fifth and five times.
template <class T>
[[gnu::always_inline]] inline T step_factor(const ErrorRatio<T>& ratio, int error_order) {
  const T factor = T(error_order < 6 ? 0.9 : 0.8) *
                   rough_power(ratio.error, ratio.allowed, -1.0 / (error_order + 1));
  const T low = 0.2, high = 5;
  // Written so that NaN, of a step that was not finite, makes the next one short.
  return select(factor > low, select(factor < high, factor, high), low);
}

/// A step that was tried: whether it is good, lane by lane, and the length of the next one.
template <class T>
struct Trial {
  decltype(T() <= T()) good;
  T next;
};

/// Tries a step of length h from `from` to `to`, and finds the next one's length.
template <class Stepper, class T, Effects E>
[[gnu::always_inline]] inline Trial<T> try_step(Stepper& stepper, const Motion<T, E>& motion,
                                                const Instant<T, E>& from,
                                                const std::type_identity_t<T>& h, Instant<T, E>& to,
                                                double tolerance) {
  State<T, E> error;
  advance(stepper, motion, from, h, to, error);
  const auto ratio = error_ratio(from, to, error, h, tolerance);
  return {ratio.error <= ratio.allowed, T(h * step_factor(ratio, stepper.error_order()))};
}

}  // namespace trebsweep
