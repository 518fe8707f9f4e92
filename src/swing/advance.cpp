#include "trebsweep/swing/advance.hpp"

#include <algorithm>
#include <memory>

#include "trebsweep/ode/steppers.hpp"

namespace trebsweep {
namespace {

template <class Stepper, Effects E>
SingleStepper single_stepper_of(const Scene& scene, const Design<double>& design,
                                const Solver& solver) {
  // Not all steppers can be copied or moved.
  const std::shared_ptr<Stepper> stepper(new Stepper(make_stepper<Stepper>(solver)));
  const auto motion_of = [of_design = Motion<double, E>(scene, design)](bool sliding) {
    Motion<double, E> motion = of_design;
    motion.set_sliding(sliding ? 1 : 0);
    return motion;
  };
  SingleStepper single{
      is_adaptive<Stepper>, is_interpolated<Stepper>, stepper->order(), 0, {}, {}, [stepper] {
        return stepper->evaluations();
      }};
  single.step = [stepper, motion_of](bool sliding, const PlainInstant& from, double h,
                                     PlainState& error) {
    Instant<double, E> to;
    State<double, E> estimate{};
    advance(*stepper, motion_of(sliding), to_instant<double, E>(from), h, to, estimate);
    std::copy(estimate.begin(), estimate.end(), error.begin());
    return to_plain(to);
  };
  if constexpr (is_own_controller<Stepper>)
    single.try_step = [stepper, motion_of](bool sliding, const PlainInstant& from, double h) {
      Instant<double, E> to;
      const auto [accepted, next] =
          stepper->try_step(motion_of(sliding), to_instant<double, E>(from), h, to);
      return PlainTrial{to_plain(to), accepted, next};
    };
  else if constexpr (is_adaptive<Stepper>)
    single.error_order = stepper->error_order();
  return single;
}

}  // namespace

SingleStepper single_stepper(const Scene& scene, const Design<double>& design,
                             const Solver& solver) {
  return with_general_effects(scene, [&]<Effects E>() {
    return with_single_stepper(solver.stepper, [&]<template <class, Effects> class Stepper>() {
      return single_stepper_of<Stepper<double, E>, E>(scene, design, solver);
    });
  });
}

PlainAdvance plain_advance(const Scene& scene, const Design<double>& design, const Solver& solver) {
  if (is_for_packs(solver.stepper))
    return
        [scene, design, name = solver.stepper](bool sliding, const PlainInstant& from, double h) {
          return advance_pack(scene, design, name, sliding, from, h);
        };
  return [single = single_stepper(scene, design, solver)](bool sliding, const PlainInstant& from,
                                                          double h) {
    PlainState error;
    return single.step(sliding, from, h, error);
  };
}

}  // namespace trebsweep
