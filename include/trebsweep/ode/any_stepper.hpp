#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// A stepper whose method is chosen at run time. The code that integrates swings is compiled once
/// for all methods that are adaptive, and once for all that have a fixed step.
template <class T, Effects E, bool adaptive>
class AnyStepper {
 public:
  using stepper_category =
      std::conditional_t<adaptive, odeint::explicit_error_stepper_tag, odeint::stepper_tag>;

  template <class Stepper>
  explicit AnyStepper(std::shared_ptr<Stepper> stepper)
      : is_interpolated_(trebsweep::is_interpolated(*stepper)) {
    static_assert(is_adaptive<Stepper> == adaptive);
    if constexpr (adaptive) {
      order_ = stepper->order();
      error_order_ = stepper->error_order();
    }
    evaluations_ = [stepper](std::uint64_t steps) {
      return trebsweep::evaluations(*stepper, steps);
    };
    step_ = [stepper](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                      Instant<T, E>& to,
                      State<T, E>& error) { advance(*stepper, motion, from, h, to, error); };
  }

  int order() const { return order_; }
  int error_order() const { return error_order_; }
  bool is_interpolated() const { return is_interpolated_; }
  std::uint64_t evaluations(std::uint64_t steps) const { return evaluations_(steps); }

  /// See advance().
  void step(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h, Instant<T, E>& to,
            State<T, E>& error) {
    step_(motion, from, h, to, error);
  }

 private:
  int order_ = 0, error_order_ = 0;
  bool is_interpolated_;
  std::function<std::uint64_t(std::uint64_t)> evaluations_;
  std::function<void(const Motion<T, E>&, const Instant<T, E>&, const T&, Instant<T, E>&,
                     State<T, E>&)>
      step_;
};

/// The AnyStepper for a stepper.
template <class T, Effects E, class Stepper>
AnyStepper<T, E, is_adaptive<Stepper>> any_stepper(const Solver& solver) {
  // Not all steppers can be copied or moved.
  return AnyStepper<T, E, is_adaptive<Stepper>>(
      std::shared_ptr<Stepper>(new Stepper(make_stepper<Stepper>(solver))));
}

/// The solver's stepper, which must be adaptive or not as chosen, and not bulirsch_stoer. T is
/// double, or long double if the stepper supports packs. Throws std::logic_error for others.
template <class T, Effects E, bool adaptive>
AnyStepper<T, E, adaptive> make_any_stepper(const Solver& solver);

/// advance(motion, from, h) is the instant a step of length h after `from`. A multistep stepper
/// keeps its history from call to call.
template <class T, Effects E>
using Advance =
    std::function<Instant<T, E>(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h)>;

/// The same for any stepper of the registry.
template <class T, Effects E>
Advance<T, E> make_advance(const Solver& solver);

}  // namespace trebsweep
