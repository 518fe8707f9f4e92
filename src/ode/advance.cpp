#include "trebsweep/ode/advance.hpp"

#include <memory>

#include "trebsweep/ode/steppers.hpp"

namespace trebsweep {

template <class T, Effects E>
Advance<T, E> make_advance(const Solver& solver) {
  const auto make = [&]<template <class, Effects = Effects{}> class Stepper>()->Advance<T, E> {
    using S = Stepper<T, E>;
    const std::shared_ptr<S> stepper(new S(make_stepper<S>(solver)));  // not all can be copied
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

template Advance<double, Effects{false, false}> make_advance(const Solver&);
template Advance<double, Effects{false, true}> make_advance(const Solver&);
template Advance<double, Effects{true, false}> make_advance(const Solver&);
template Advance<double, Effects{true, true}> make_advance(const Solver&);
template Advance<long double, Effects{false, false}> make_advance(const Solver&);
template Advance<long double, Effects{false, true}> make_advance(const Solver&);
template Advance<long double, Effects{true, false}> make_advance(const Solver&);
template Advance<long double, Effects{true, true}> make_advance(const Solver&);

}  // namespace trebsweep
