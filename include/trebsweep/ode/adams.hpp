#pragma once

#include <boost/numeric/odeint/stepper/adams_bashforth_moulton.hpp>
#include <cstdint>

#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// Odeint's five-step Adams-Bashforth-Moulton method. A step that does not start where the previous
/// one ended restarts the history. A step of a different length, as event location needs, is taken
/// by fehlberg78 and leaves the history unchanged.
template <class T, Effects E = Effects{}>
class AdamsBashforthMoulton {
 public:
  using stepper_category = odeint::stepper_tag;

  explicit AdamsBashforthMoulton(const Solver& solver) : h_(solver.time_step) {}

  int order() const { return Base::order_value; }
  std::uint64_t evaluations() const { return evaluations_; }

  /// See advance().
  void step(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h, Instant<T, E>& to,
            State<T, E>& error) {
    if (h != h_) {
      Fehlberg78<T, E> single;
      return advance(single, motion, from, h, to, error);
    }
    if (from.t != end_.t || from.x != end_.x) stepper_.reset();
    const auto rates = [&](const State<T, E>& x, State<T, E>& dxdt, const T& t) {
      motion(x, dxdt, t);
      ++evaluations_;
    };
    State<T, E> x;
    stepper_.do_step(rates, from.x, T(0), x, h);
    to = end_ = instant(motion, from.t + h, x);
  }

 private:
  using Base = odeint::adams_bashforth_moulton<5, State<T, E>, T, State<T, E>, T,
                                               odeint::array_algebra, odeint::default_operations>;

  Base stepper_;
  T h_;
  Instant<T, E> end_{};
  std::uint64_t evaluations_ = 0;
};

}  // namespace trebsweep
