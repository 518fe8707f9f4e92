#pragma once

#include <functional>

#include "trebsweep/ode/step_size.hpp"

namespace trebsweep {

/// A stepper whose method is chosen at run time, so that the code that integrates swings is
/// compiled once for all methods.
template <class T, Effects E>
struct AnyStepper {
  bool adaptive;           ///< otherwise its steps have a fixed length
  bool interpolated;       ///< see is_interpolated
  int order, error_order;  ///< of an adaptive method
  /// See advance().
  std::function<void(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                     Instant<T, E>& to, State<T, E>& error)>
      step;
  /// See try_step(). Empty, unless the stepper chooses the length of its steps itself.
  std::function<Trial<T>(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                         Instant<T, E>& to)>
      try_step = {};
};

/// Takes a step of length h from `from` to `to`, decides whether it is accepted, and chooses the
/// length of the next step. For adaptive steppers.
template <class T, Effects E>
[[gnu::always_inline]] inline Trial<T> try_step(const AnyStepper<T, E>& stepper,
                                                const Motion<T, E>& motion,
                                                const Instant<T, E>& from, const T& h,
                                                Instant<T, E>& to, double tolerance) {
  if (stepper.try_step) [[unlikely]]
    return stepper.try_step(motion, from, h, to);
  State<T, E> error;
  advance(stepper, motion, from, h, to, error);
  const auto ratio = error_ratio(from, to, error, h, tolerance);
  return {ratio.error <= ratio.allowed, T(h * step_factor(ratio, stepper.error_order))};
}

/// The AnyStepper of a type of stepper without state.
template <class T, Effects E, class Stepper>
AnyStepper<T, E> any_stepper() {
  AnyStepper<T, E> any{is_adaptive<Stepper>, is_interpolated<Stepper>, 0, 0,
                       [](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                          Instant<T, E>& to, State<T, E>& error) {
                         Stepper stepper;
                         advance(stepper, motion, from, h, to, error);
                       }};
  if constexpr (is_adaptive<Stepper>) {
    any.order = Stepper().order();
    any.error_order = Stepper().error_order();
  }
  return any;
}

}  // namespace trebsweep
