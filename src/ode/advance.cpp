#include "trebsweep/ode/advance.hpp"

#include <memory>

#include "trebsweep/ode/steppers.hpp"

namespace trebsweep {

template <class T, Effects E>
Advance<T, E> make_advance(const Solver& solver) {
  const auto make = [&]<template <class, Effects = Effects{}> class Stepper>()->Advance<T, E> {
    using S = Stepper<T, E>;
    // Not all steppers can be copied or moved.
    const std::shared_ptr<S> stepper(new S(make_stepper<S>(solver)));
    return [stepper](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h) {
      Instant<T, E> to;
      State<T, E> error;
      advance(*stepper, motion, from, h, to, error);
      return to;
    };
  };
  if constexpr (std::is_same_v<T, double>)
    return with_stepper(solver.stepper, make);
  else
    return with_pack_stepper(solver.stepper, make);
}

static_assert(general_effects.size() == 5);
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
