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
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "trebsweep/algebra.hpp"
#include "trebsweep/motion.hpp"

namespace trebsweep {

namespace odeint = boost::numeric::odeint;

/// A stepper with a step of its own for each lane.
template <template <class, class, class, class, class, class, class> class Stepper, class T>
using FixedStepper = Stepper<State<T>, T, State<T>, T, odeint::array_algebra,
                             odeint::default_operations, odeint::never_resizer>;

/// A state and its directions: the state of an adaptive stepper. Within a step, sines and cosines
/// are integrated beside the angles, which costs less than to compute them in every stage.
template <class T>
using ExtendedState = std::array<T, 8>;

/// A stepper whose time is the part of the step that has passed: all lanes' steps are one, and the
/// method's coefficients are single numbers.
template <template <class, class, class, class, class, class, class> class Stepper, class T>
using AdaptiveStepper =
    Stepper<ExtendedState<T>, typename Lanes<T>::Number, ExtendedState<T>,
            typename Lanes<T>::Number, Algebra, Operations, odeint::never_resizer>;

// The steppers that a swing can use.
template <class T>
using Euler = FixedStepper<odeint::euler, T>;
template <class T>
using RungeKutta4 = FixedStepper<odeint::runge_kutta4, T>;
template <class T>
using CashKarp54 = AdaptiveStepper<odeint::runge_kutta_cash_karp54, T>;
template <class T>
using Dopri5 = AdaptiveStepper<odeint::runge_kutta_dopri5, T>;
template <class T>
using Fehlberg78 = AdaptiveStepper<odeint::runge_kutta_fehlberg78, T>;

/// Whether the stepper estimates its error, so that its step can follow a tolerance.
template <class Stepper>
inline constexpr bool is_adaptive =
    std::is_base_of_v<odeint::error_stepper_tag, typename Stepper::stepper_category>;

/// A moment of a swing: its time (s), state, the state's directions and its rate there.
template <class T>
struct Instant {
  T t;
  State<T> x;
  Directions<T> at;
  State<T> dxdt;
};

/// The instant of a state.
template <class T>
Instant<T> instant(const Motion<T>& motion, const T& t, const State<T>& x) {
  Instant<T> now{t, x, directions(x), {}};
  motion.rates(now.x, now.at, now.dxdt);
  return now;
}

/// The extended state's rate over a step of length h.
template <class T>
void extend_rates(const State<T>& dxdt, std::span<const T, 4> at, const T& h,
                  ExtendedState<T>& rates) {
  for (std::size_t i = 0; i < 4; ++i) rates[i] = h * dxdt[i];
  rates[4 + sin1] = rates[phi1] * at[cos1];
  rates[4 + cos1] = T(0) - rates[phi1] * at[sin1];
  rates[4 + sin2] = rates[phi2] * at[cos2];
  rates[4 + cos2] = T(0) - rates[phi2] * at[sin2];
}

/// The instant a step of length h after `from`. An adaptive stepper also fills `error`, its
/// estimate of the step's error; the others leave it alone.
template <class Stepper, class T>
void advance(Stepper& stepper, const Motion<T>& motion, const Instant<T>& from, const T& h,
             Instant<T>& to, State<T>& error) {
  to.t = from.t + h;
  if constexpr (is_adaptive<Stepper>) {
    using Number = typename Lanes<T>::Number;
    State<T> dxdt;  // not `to` itself: the compiler would have to store that in every stage
    const auto directions_of = [](const ExtendedState<T>& y) {
      return std::span(y).template last<4>();
    };
    const auto system = [&](const ExtendedState<T>& y, ExtendedState<T>& rates, const Number&) {
      motion.rates(std::span(y).template first<4>(), directions_of(y), dxdt);
      extend_rates(dxdt, directions_of(y), h, rates);
    };
    ExtendedState<T> start, start_rates, end, end_rates, difference;
    for (std::size_t i = 0; i < 4; ++i) start[i] = from.x[i], start[4 + i] = from.at[i];
    extend_rates<T>(from.dxdt, from.at, h, start_rates);
    if constexpr (std::is_same_v<typename Stepper::stepper_category,
                                 odeint::explicit_error_stepper_fsal_tag>) {
      stepper.do_step(system, start, start_rates, Number(0), end, end_rates, Number(1), difference);
    } else {
      stepper.do_step(system, start, start_rates, Number(0), end, Number(1), difference);
      system(end, end_rates, Number(1));
    }
    for (std::size_t i = 0; i < 4; ++i) {
      to.x[i] = end[i];
      to.at[i] = end[4 + i];
      to.dxdt[i] = dxdt[i];
      error[i] = difference[i];
    }
  } else {
    stepper.do_step(std::cref(motion), from.x, from.dxdt, from.t, to.x, h);
    to.at = directions(to.x);
    motion.rates(to.x, to.at, to.dxdt);
  }
}

/// The same for packs, with all of Odeint inlined: what it passes from call to call is registers.
/// With a stepper made on the spot, the compiler knows its coefficients.
template <class Stepper, std::size_t R>
[[gnu::flatten]] inline void advance(Stepper&, const Motion<Pack<R>>& motion,
                                     const Instant<Pack<R>>& from, const Pack<R>& h,
                                     Instant<Pack<R>>& to, State<Pack<R>>& error) {
  Stepper stepper;
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
