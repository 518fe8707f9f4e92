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

/// A stepper of Odeint over the number type T, with a time of its own for each lane.
template <template <class, class, class, class, class, class, class> class Stepper, class T>
using StepperOver = Stepper<State<T>, T, State<T>, T, odeint::array_algebra,
                            odeint::default_operations, odeint::never_resizer>;

// The steppers that a swing can use.
template <class T>
using Euler = StepperOver<odeint::euler, T>;
template <class T>
using RungeKutta4 = StepperOver<odeint::runge_kutta4, T>;
template <class T>
using CashKarp54 = StepperOver<odeint::runge_kutta_cash_karp54, T>;
template <class T>
using Dopri5 = StepperOver<odeint::runge_kutta_dopri5, T>;
template <class T>
using Fehlberg78 = StepperOver<odeint::runge_kutta_fehlberg78, T>;

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
void advance(Stepper& stepper, const Motion<T>& motion, const Instant<T>& from, const T& h,
             Instant<T>& to, State<T>& error) {
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
}

/// The same for packs, with all of Odeint inlined: what it passes from call to call is registers.
template <class Stepper, std::size_t R>
[[gnu::flatten]] inline void advance(Stepper& stepper, const Motion<Pack<R>>& motion,
                                     const Instant<Pack<R>>& from, const Pack<R>& h,
                                     Instant<Pack<R>>& to, State<Pack<R>>& error) {
  advance<Stepper, Pack<R>>(stepper, motion, from, h, to, error);
}

/// Names a job can choose a stepper by.
inline constexpr std::array<std::string_view, 5> stepper_names{"euler", "rk4", "cash_karp54",
                                                               "dopri5", "fehlberg78"};

/// Calls f<Stepper>() with the stepper of that name, one of stepper_names.
template <class F>
auto with_stepper(std::string_view name, F&& f) {
  if (name == "euler") return f.template operator()<Euler>();
  if (name == "rk4") return f.template operator()<RungeKutta4>();
  if (name == "cash_karp54") return f.template operator()<CashKarp54>();
  if (name == "dopri5") return f.template operator()<Dopri5>();
  if (name == "fehlberg78") return f.template operator()<Fehlberg78>();
  throw std::logic_error("no stepper is named " + std::string(name));
}

}  // namespace trebsweep
