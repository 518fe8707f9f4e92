#include "trebsweep/swing/advance.hpp"

#include <memory>

#include "trebsweep/ode/steppers.hpp"
#include "trebsweep/swing/plain_instant.hpp"

namespace trebsweep {

template <Effects E>
Advance<E> make_advance(const Scene& scene, const Design<double>& design, const Solver& solver) {
  using Motion = trebsweep::Motion<double, E>;
  using Instant = trebsweep::Instant<double, E>;
  if (is_for_packs(solver.stepper))
    return [scene, design, name = solver.stepper](const Motion& motion, const Instant& from,
                                                  double h) {
      return to_instant<double, E>(
          advance_pack(scene, design, name, motion.sliding() > 0, to_plain(from), h));
    };
  return with_single_stepper(solver.stepper, [&]<template <class, Effects> class Stepper>() {
    using S = Stepper<double, E>;
    // Not all steppers can be copied or moved.
    const std::shared_ptr<S> stepper(new S(make_stepper<S>(solver)));
    return Advance<E>([stepper](const Motion& motion, const Instant& from, double h) {
      Instant to;
      State<double, E> error;
      advance(*stepper, motion, from, h, to, error);
      return to;
    });
  });
}

static_assert(general_effects.size() == 5);
template Advance<general_effects[0]> make_advance(const Scene&, const Design<double>&,
                                                  const Solver&);
template Advance<general_effects[1]> make_advance(const Scene&, const Design<double>&,
                                                  const Solver&);
template Advance<general_effects[2]> make_advance(const Scene&, const Design<double>&,
                                                  const Solver&);
template Advance<general_effects[3]> make_advance(const Scene&, const Design<double>&,
                                                  const Solver&);
template Advance<general_effects[4]> make_advance(const Scene&, const Design<double>&,
                                                  const Solver&);

}  // namespace trebsweep
