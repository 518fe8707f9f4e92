#include "trebsweep/swing/swing.hpp"

#include "trebsweep/ode/steppers.hpp"
#include "trebsweep/swing/swing_by.hpp"

namespace trebsweep {

template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe, std::span<const Field> fields,
                         std::span<double> values) {
  const auto observe_if_given = [&](const Instant<double, E>& from, const Instant<double, E>& to) {
    if (observe) observe(from, to);
  };
  return with_stepper(
      solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
        return swing_by<Stepper<double, E>, double, E>(scene, design, solver, observe_if_given,
                                                       fields, values);
      });
}

template Outcome<double, Effects{false, false}> swing(const Scene&, const Design<double>&,
                                                      const Solver&,
                                                      const Observer<Effects{false, false}>&,
                                                      std::span<const Field>, std::span<double>);
template Outcome<double, Effects{false, true}> swing(const Scene&, const Design<double>&,
                                                     const Solver&,
                                                     const Observer<Effects{false, true}>&,
                                                     std::span<const Field>, std::span<double>);
template Outcome<double, Effects{true, false}> swing(const Scene&, const Design<double>&,
                                                     const Solver&,
                                                     const Observer<Effects{true, false}>&,
                                                     std::span<const Field>, std::span<double>);
template Outcome<double, Effects{true, true}> swing(const Scene&, const Design<double>&,
                                                    const Solver&,
                                                    const Observer<Effects{true, true}>&,
                                                    std::span<const Field>, std::span<double>);

}  // namespace trebsweep
