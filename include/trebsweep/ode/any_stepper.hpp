#pragma once

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// A stepper whose method, which has no state, is chosen at run time. The code that integrates
/// swings is compiled once for all methods that are adaptive, and once for all that have a fixed
/// step.
template <class T, Effects E, bool adaptive>
class AnyStepper {
 public:
  using stepper_category =
      std::conditional_t<adaptive, odeint::explicit_error_stepper_tag, odeint::stepper_tag>;

  int order() const { return order_; }
  int error_order() const { return error_order_; }

  /// See advance().
  void step(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h, Instant<T, E>& to,
            State<T, E>& error) {
    step_(motion, from, h, to, error);
  }

  /// That of a type of stepper.
  template <class Stepper>
  static AnyStepper of() {
    static_assert(is_adaptive<Stepper> == adaptive);
    AnyStepper any;
    if constexpr (adaptive) {
      const Stepper stepper;
      any.order_ = stepper.order();
      any.error_order_ = stepper.error_order();
    }
    any.step_ = [](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                   Instant<T, E>& to, State<T, E>& error) {
      Stepper method;
      advance(method, motion, from, h, to, error);
    };
    return any;
  }

 private:
  int order_ = 0, error_order_ = 0;
  void (*step_)(const Motion<T, E>&, const Instant<T, E>&, const T&, Instant<T, E>&,
                State<T, E>&) = nullptr;
};

/// The AnyStepper for a type of stepper.
template <class T, Effects E, class Stepper>
AnyStepper<T, E, is_adaptive<Stepper>> any_stepper() {
  return AnyStepper<T, E, is_adaptive<Stepper>>::template of<Stepper>();
}

}  // namespace trebsweep
