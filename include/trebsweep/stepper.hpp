#pragma once

#include <array>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/algebra/default_operations.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/stepper/stepper_categories.hpp>
#include <boost/numeric/odeint/util/resizer.hpp>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "trebsweep/motion.hpp"

namespace trebsweep {

namespace odeint = boost::numeric::odeint;

/// The steppers of Odeint that a swing can use, over any number type.
template <class T>
struct Steppers {
  template <template <class, class, class, class, class, class, class> class Stepper>
  using Of = Stepper<State<T>, T, State<T>, T, odeint::array_algebra, odeint::default_operations,
                     odeint::never_resizer>;

  using Euler = Of<odeint::euler>;
  using RungeKutta4 = Of<odeint::runge_kutta4>;
  using CashKarp54 = Of<odeint::runge_kutta_cash_karp54>;
  using Dopri5 = Of<odeint::runge_kutta_dopri5>;
  using Fehlberg78 = Of<odeint::runge_kutta_fehlberg78>;
};

/// Whether the stepper estimates its error, so that its step can follow a tolerance.
template <class Stepper>
inline constexpr bool is_adaptive =
    std::is_base_of_v<odeint::error_stepper_tag, typename Stepper::stepper_category>;

/// A moment of a swing: its time (s), state, and the state's rate there.
template <class T>
struct Instant {
  T t;
  State<T> x;
  State<T> dxdt;
};

/// The instant a step of length h after `from`. An adaptive stepper also fills `error`, its
/// estimate of the step's error; the others leave it alone.
template <class Stepper, class T>
Instant<T> advance(Stepper& stepper, const Motion<T>& motion, const Instant<T>& from, const T& h,
                   State<T>& error) {
  Instant<T> to;
  to.t = from.t + h;
  const auto system = std::cref(motion);
  if constexpr (std::is_same_v<typename Stepper::stepper_category,
                               odeint::explicit_error_stepper_fsal_tag>) {
    stepper.do_step(system, from.x, from.dxdt, from.t, to.x, to.dxdt, h, error);
  } else {
    if constexpr (is_adaptive<Stepper>)
      stepper.do_step(system, from.x, from.dxdt, from.t, to.x, h, error);
    else
      stepper.do_step(system, from.x, from.dxdt, from.t, to.x, h);
    motion(to.x, to.dxdt, to.t);
  }
  return to;
}

/// Names a job can choose a stepper by.
inline constexpr std::array<std::string_view, 5> stepper_names{"euler", "rk4", "cash_karp54",
                                                               "dopri5", "fehlberg78"};

/// Calls `f` with a std::type_identity of the stepper of that name, one of stepper_names.
template <class T, class F>
auto with_stepper(std::string_view name, F&& f) {
  using S = Steppers<T>;
  if (name == "euler") return f(std::type_identity<typename S::Euler>{});
  if (name == "rk4") return f(std::type_identity<typename S::RungeKutta4>{});
  if (name == "cash_karp54") return f(std::type_identity<typename S::CashKarp54>{});
  if (name == "dopri5") return f(std::type_identity<typename S::Dopri5>{});
  if (name == "fehlberg78") return f(std::type_identity<typename S::Fehlberg78>{});
  throw std::logic_error("no stepper is named " + std::string(name));
}

}  // namespace trebsweep
