#pragma once

#include <cstdint>

#include "trebsweep/model/jacobian.hpp"
#include "trebsweep/ode/rosenbrock_step.hpp"
#include "trebsweep/ode/stepper.hpp"

namespace trebsweep {

/// Odeint's Rosenbrock method of order 4, for stiff scenes: linearly implicit, with the Jacobian
/// evaluated in every step.
template <class T, Effects E = Effects{}>
class Rosenbrock4 {
  static_assert(std::is_same_v<T, double>);

 public:
  using stepper_category = odeint::error_stepper_tag;

  int order() const { return RosenbrockStep::order(); }
  int error_order() const { return RosenbrockStep::error_order(); }

  /// Evaluations of the right-hand side so far, without those for Jacobians.
  std::uint64_t evaluations() const { return evaluations_; }

  /// See advance().
  void step(const Motion<T, E>& motion, const Instant<T, E>& from, T h, Instant<T, E>& to,
            State<T, E>& error) {
    if (h == 0) {  // the method divides by it
      to = from;
      return error.fill(0);
    }
    const auto at = [](const T* x) {
      State<T, E> state;
      std::copy_n(x, state.size(), state.begin());
      return state;
    };
    const auto rates = [&](const T* x, T* dxdt) {
      const auto now = instant(motion, 0, at(x));
      std::copy(now.dxdt.begin(), now.dxdt.end(), dxdt);
      ++evaluations_;
    };
    const auto derivatives = [&](const T* x, T* rows) {
      constexpr auto n = static_cast<Eigen::Index>(coordinates<E>);
      Eigen::Map<Eigen::Matrix<T, n, n, Eigen::RowMajor>>{rows} = jacobian(motion, at(x));
    };
    State<T, E> end;
    step_.step(rates, derivatives, from.x.data(), h, end.data(), error.data());
    to = instant(motion, from.t + h, end);
  }

 private:
  RosenbrockStep step_{coordinates<E>};
  std::uint64_t evaluations_ = 0;
};

}  // namespace trebsweep
