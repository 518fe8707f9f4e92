#pragma once

#include <boost/numeric/odeint/stepper/bulirsch_stoer.hpp>
#include <cmath>
#include <cstdint>

#include "trebsweep/ode/step_size.hpp"

namespace trebsweep {

/// Odeint's Bulirsch-Stoer extrapolation of the modified midpoint method, of variable order up to
/// 16, with its own control of order and step size.
template <class T, Effects E = Effects{}>
class BulirschStoer {
 public:
  using stepper_category = odeint::controlled_stepper_tag;

  explicit BulirschStoer(const Solver& solver)
      : tolerance_(solver.tolerance), stepper_(tolerance_, tolerance_) {}

  int order() const { return 8; }  // for the choice of the first step
  std::uint64_t evaluations() const { return evaluations_; }

  /// See try_step().
  Trial<T> try_step(const Motion<T, E>& motion, const Instant<T, E>& from, T h, Instant<T, E>& to) {
    if (from.t == T(0)) stepper_.reset();  // discards the order and step size of the last swing
    State<T, E> x = from.x;
    T t = 0, next = h;
    const bool good =
        stepper_.try_step(rates(motion), from.x, from.dxdt, t, x, next) == odeint::success;
    to = instant(motion, from.t + h, x);
    // Odeint's error check would accept NaN.
    T sum = next;
    for (std::size_t i = 0; i < coordinates<E>; ++i) sum += to.x[i] + to.dxdt[i];
    if (!is_finite_sum(sum)) return {false, h / 5};
    return {good, next};
  }

  /// See advance(). Takes as many steps of its own as necessary; the state is NaN if 1000 do not
  /// suffice.
  void step(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h, Instant<T, E>& to,
            State<T, E>& /*error*/) {
    constexpr int most = 1000;
    Base stepper(tolerance_, tolerance_);
    State<T, E> x = from.x;
    T t = 0, next = h;
    for (int tries = 0; t < h && tries < most; ++tries) {
      next = std::min(next, T(h - t));
      stepper.try_step(rates(motion), x, t, next);
    }
    if (t < h) x.fill(std::numeric_limits<T>::quiet_NaN());
    to = instant(motion, from.t + h, x);
  }

 private:
  using Base = odeint::bulirsch_stoer<State<T, E>, T, State<T, E>, T, odeint::array_algebra>;

  auto rates(const Motion<T, E>& motion) {
    return [&](const State<T, E>& x, State<T, E>& dxdt, const T& t) {
      motion(x, dxdt, t);
      ++evaluations_;
    };
  }

  T tolerance_;
  Base stepper_;
  std::uint64_t evaluations_ = 0;
};

}  // namespace trebsweep
