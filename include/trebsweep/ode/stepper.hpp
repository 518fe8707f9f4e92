#pragma once

#include <array>
#include <boost/numeric/odeint/algebra/array_algebra.hpp>
#include <boost/numeric/odeint/algebra/default_operations.hpp>
#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_cash_karp54.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/stepper/stepper_categories.hpp>
#include <boost/numeric/odeint/util/resizer.hpp>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

#include "trebsweep/ode/algebra.hpp"
#include "trebsweep/ode/instant.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/ode/verner.hpp"

namespace trebsweep {

namespace odeint = boost::numeric::odeint;

/// A fixed-step stepper: every lane has its own time and step length.
template <template <class, class, class, class, class, class, class> class Stepper, class T,
          Effects E>
using FixedStepper = Stepper<State<T, E>, T, State<T, E>, T, odeint::array_algebra,
                             odeint::default_operations, odeint::never_resizer>;

/// The state of an adaptive stepper: a state and the sines and cosines of its angles. Within a
/// step, these are integrated with the angles, which is cheaper than computing them in every stage.
template <class T, Effects E = Effects{}>
using ExtendedState = std::array<T, coordinates<E> + direction_count<E>>;

/// An adaptive stepper. Its independent variable is the fraction of the step, so that all lanes
/// take a step of length one and the coefficients of the method remain scalars.
template <template <class, class, class, class, class, class, class> class Stepper, class T,
          Effects E>
using AdaptiveStepper =
    Stepper<ExtendedState<T, E>, typename Lanes<T>::Number, ExtendedState<T, E>,
            typename Lanes<T>::Number, Algebra, Operations, odeint::never_resizer>;

// The steppers for any number type, packs included.
template <class T, Effects E = Effects{}>
using Euler = FixedStepper<odeint::euler, T, E>;
template <class T, Effects E = Effects{}>
using ModifiedMidpoint = FixedStepper<odeint::modified_midpoint, T, E>;
template <class T, Effects E = Effects{}>
using RungeKutta4 = FixedStepper<odeint::runge_kutta4, T, E>;
template <class T, Effects E = Effects{}>
using CashKarp54 = AdaptiveStepper<odeint::runge_kutta_cash_karp54, T, E>;
template <class T, Effects E = Effects{}>
using Dopri5 = AdaptiveStepper<odeint::runge_kutta_dopri5, T, E>;
template <class T, Effects E = Effects{}>
using Fehlberg78 = AdaptiveStepper<odeint::runge_kutta_fehlberg78, T, E>;
template <class T, Effects E = Effects{}>
using Vern7 = AdaptiveStepper<Verner76, T, E>;
template <class T, Effects E = Effects{}>
using Vern8 = AdaptiveStepper<Verner87, T, E>;

/// Whether the stepper controls its step size itself.
template <class Stepper>
inline constexpr bool is_own_controller =
    std::is_base_of_v<odeint::controlled_stepper_tag, typename Stepper::stepper_category>;

/// Whether the stepper estimates its error, so that the step size can follow a tolerance.
template <class Stepper>
inline constexpr bool is_adaptive =
    std::is_base_of_v<odeint::error_stepper_tag, typename Stepper::stepper_category> ||
    is_own_controller<Stepper>;

/// Whether loads within a step are those of the interpolated motion, which is much cheaper than
/// integrating to each node. Not for implicit steppers, since the forces of a stiff scene amplify
/// errors of the state, nor for fixed-step methods, whose steps may be inaccurate.
template <class Stepper>
inline constexpr bool is_interpolated =
    is_adaptive<Stepper> &&
    !std::is_same_v<typename Stepper::stepper_category, odeint::error_stepper_tag>;

/// The stepper for a solver; some are constructed with its step or its tolerance.
template <class Stepper>
Stepper make_stepper(const Solver& solver) {
  if constexpr (std::is_constructible_v<Stepper, const Solver&>)
    return Stepper(solver);
  else
    return Stepper();
}

/// Sets the rates of the sines and cosines in an extended state y, from the rates of its angles.
template <Effects E, class T>
void set_direction_rates(const ExtendedState<T, E>& y, ExtendedState<T, E>& rates) {
  constexpr std::size_t n = coordinates<E>;
  const auto set = [&](std::size_t angle, std::size_t sin, std::size_t cos) {
    rates[n + sin] = rates[angle] * y[n + cos];
    rates[n + cos] = T(0) - rates[angle] * y[n + sin];
  };
  set(phi1, sin1, cos1);
  set(phi2, sin2, cos2);
  if constexpr (E.hanger) set(phi3, sin3, cos3);
}

/// Whether a stepper has a member function step() that advance() calls.
template <class Stepper, class T, Effects E>
concept HasStep = requires(Stepper& stepper, const Motion<T, E>& motion, Instant<T, E>& at,
                           const T& h, State<T, E>& error) {
  stepper.step(motion, at, h, at, error);
};

// Loops over coordinates are unrolled by a pragma: not every compiler would do so by itself, and
// otherwise the arrays of packs would be copied through memory.

/// Sets `to` to the instant one step of length h after `from`; h must not be zero. An adaptive
/// stepper also sets `error`, its estimate of the local error; the other steppers do not change it.
template <class Stepper, class T, Effects E>
void advance(Stepper& stepper, const Motion<T, E>& motion, const Instant<T, E>& from,
             const std::type_identity_t<T>& h, Instant<T, E>& to, State<T, E>& error) {
  to.t = from.t + h;
  if constexpr (HasStep<Stepper, T, E>) {
    stepper.step(motion, from, h, to, error);
  } else if constexpr (is_adaptive<Stepper>) {
    using Number = typename Lanes<T>::Number;
    constexpr std::size_t n = coordinates<E>;
    // With the time in units of h, no stage has to multiply its rates by h.
    const Motion<T, E> scaled = motion.in_units_of(h);
    const auto system = [&](const ExtendedState<T, E>& y, ExtendedState<T, E>& rates,
                            const Number&) {
      scaled.rates(std::span(y).template first<n>(),
                   std::span(y).template last<direction_count<E>>(),
                   std::span(rates).template first<n>());
      set_direction_rates<E>(y, rates);
    };
    const T per_h = T(1) / h;
    const auto unit = [&](std::size_t i) { return is_rate(i) ? h : T(1); };
    const auto per_unit = [&](std::size_t i) { return is_rate(i) ? per_h : T(1); };
    ExtendedState<T, E> start, start_rates, end, end_rates, difference;
#pragma GCC unroll 8
    for (std::size_t i = 0; i < n; ++i) {
      start[i] = unit(i) * from.x[i];
      start_rates[i] = h * unit(i) * from.dxdt[i];
    }
#pragma GCC unroll 8
    for (std::size_t i = 0; i < direction_count<E>; ++i) start[n + i] = from.directions[i];
    set_direction_rates<E>(start, start_rates);
    if constexpr (std::is_same_v<typename Stepper::stepper_category,
                                 odeint::explicit_error_stepper_fsal_tag>) {
      stepper.do_step(system, start, start_rates, Number(0), end, end_rates, Number(1), difference);
    } else {
      stepper.do_step(system, start, start_rates, Number(0), end, Number(1), difference);
      system(end, end_rates, Number(1));
    }
#pragma GCC unroll 8
    for (std::size_t i = 0; i < n; ++i) {
      to.x[i] = per_unit(i) * end[i];
      to.dxdt[i] = per_h * per_unit(i) * end_rates[i];
      error[i] = per_unit(i) * difference[i];
    }
#pragma GCC unroll 8
    for (std::size_t i = 0; i < direction_count<E>; ++i) to.directions[i] = end[n + i];
  } else {
    stepper.do_step(std::cref(motion), from.x, from.dxdt, from.t, to.x, h);
    to.directions = directions<E>(to.x);
    motion.rates(to.x, to.directions, to.dxdt);
  }
}

/// An adaptive stepper for packs of one register instead of R.
template <class Stepper>
struct OneRegister;

template <template <class, class, class, class, class, class, class> class Stepper, std::size_t R,
          std::size_t N, class Number, class Resizer>
struct OneRegister<Stepper<std::array<Pack<R>, N>, Number, std::array<Pack<R>, N>, Number, Algebra,
                           Operations, Resizer>> {
  using type = Stepper<std::array<Pack<1>, N>, Number, std::array<Pack<1>, N>, Number, Algebra,
                       Operations, Resizer>;
};

/// Advances register r of a pack. A step has more values than there are registers: those of a
/// single register of lanes have to be stored and loaded less often. The attribute noipa keeps GCC
/// from inlining it; Clang, whose code is faster inlined, does not know it.
template <class Stepper, std::size_t R, Effects E>
[[gnu::flatten, gnu::noipa]] inline void advance_register(const Motion<Pack<R>, E>& motion,
                                                          const Instant<Pack<R>, E>& from,
                                                          const Pack<R>& h, Instant<Pack<R>, E>& to,
                                                          State<Pack<R>, E>& error, std::size_t r) {
  using One = Pack<1>;
  Instant<One, E> end;
  State<One, E> difference;
  typename OneRegister<Stepper>::type stepper;
  advance<typename OneRegister<Stepper>::type, One, E>(
      stepper, get_register<Motion<One, E>, R>(motion, r),
      get_register<Instant<One, E>, R>(from, r), get_register<One, R>(h, r), end, difference);
  set_register<R>(to, r, end);
  set_register<R>(error, r, difference);
}

/// The same for packs, with all of Odeint inlined so that values stay in registers. The
/// coefficients of a local stepper are constants to the compiler.
template <class Stepper, std::size_t R, Effects E>
[[gnu::flatten]] inline void advance(Stepper& given, const Motion<Pack<R>, E>& motion,
                                     const Instant<Pack<R>, E>& from, const Pack<R>& h,
                                     Instant<Pack<R>, E>& to, State<Pack<R>, E>& error) {
  if constexpr (HasStep<Stepper, Pack<R>, E>) {
    given.step(motion, from, h, to, error);
  } else if constexpr (is_adaptive<Stepper> && R > 1) {
    for (std::size_t r = 0; r < R; ++r) advance_register<Stepper>(motion, from, h, to, error, r);
  } else {
    Stepper stepper;
    advance<Stepper, Pack<R>, E>(stepper, motion, from, h, to, error);
  }
}

/// Calls f.operator()<Stepper>() with the class template Stepper<T, E> of that name. Throws
/// std::logic_error if the stepper does not support packs.
template <class F>
auto with_pack_stepper(std::string_view name, F&& f) {
  switch (info_of_stepper(name).id) {
    case StepperId::euler:
      return f.template operator()<Euler>();
    case StepperId::modified_midpoint:
      return f.template operator()<ModifiedMidpoint>();
    case StepperId::rk4:
      return f.template operator()<RungeKutta4>();
    case StepperId::cash_karp54:
      return f.template operator()<CashKarp54>();
    case StepperId::dopri5:
      return f.template operator()<Dopri5>();
    case StepperId::fehlberg78:
      return f.template operator()<Fehlberg78>();
    case StepperId::vern7:
      return f.template operator()<Vern7>();
    case StepperId::vern8:
      return f.template operator()<Vern8>();
    case StepperId::adams_bashforth_moulton:
    case StepperId::bulirsch_stoer:
    case StepperId::rosenbrock4:
      break;
  }
  throw std::logic_error(std::string(name) + " is not a stepper for packs");
}

}  // namespace trebsweep
