#include "trebsweep/ode/any_stepper.hpp"

#include "trebsweep/ode/steppers.hpp"

namespace trebsweep {

template <class T, Effects E, bool adaptive>
AnyStepper<T, E, adaptive> make_any_stepper(const Solver& solver) {
  const auto make = [&]<template <class, Effects = Effects{}> class Stepper>()
                        ->AnyStepper<T, E, adaptive> {
    using S = Stepper<T, E>;
    if constexpr (is_adaptive<S> == adaptive && !is_own_controller<S>)
      return any_stepper<T, E, S>(solver);
    else
      throw std::logic_error(solver.stepper + " is another kind of stepper");
  };
  if constexpr (std::is_same_v<T, double>)
    return with_stepper(solver.stepper, make);
  else
    return with_pack_stepper(solver.stepper, make);
}

template <class T, Effects E>
Advance<T, E> make_advance(const Solver& solver) {
  const auto advance_by = [](auto stepper) -> Advance<T, E> {
    return [stepper](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h) {
      Instant<T, E> to;
      State<T, E> error;
      advance(*stepper, motion, from, h, to, error);
      return to;
    };
  };
  const auto any = [&]<bool adaptive>() {
    return advance_by(
        std::make_shared<AnyStepper<T, E, adaptive>>(make_any_stepper<T, E, adaptive>(solver)));
  };
  if constexpr (std::is_same_v<T, double>) {
    if (info_of_stepper(solver.stepper).id == StepperId::bulirsch_stoer)
      return advance_by(std::make_shared<BulirschStoer<T, E>>(solver));
  }
  return follows_tolerance(solver.stepper) ? any.template operator()<true>()
                                           : any.template operator()<false>();
}

static_assert(general_effects.size() == 5);
template AnyStepper<double, general_effects[0], true> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[0], false> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[1], true> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[1], false> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[2], true> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[2], false> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[3], true> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[3], false> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[4], true> make_any_stepper(const Solver&);
template AnyStepper<double, general_effects[4], false> make_any_stepper(const Solver&);
template Advance<double, general_effects[0]> make_advance(const Solver&);
template Advance<long double, general_effects[0]> make_advance(const Solver&);
template Advance<double, general_effects[1]> make_advance(const Solver&);
template Advance<long double, general_effects[1]> make_advance(const Solver&);
template Advance<double, general_effects[2]> make_advance(const Solver&);
template Advance<long double, general_effects[2]> make_advance(const Solver&);
template Advance<double, general_effects[3]> make_advance(const Solver&);
template Advance<long double, general_effects[3]> make_advance(const Solver&);
template Advance<double, general_effects[4]> make_advance(const Solver&);
template Advance<long double, general_effects[4]> make_advance(const Solver&);

}  // namespace trebsweep
