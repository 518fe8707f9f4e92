#include "trebsweep/swing/pack_steppers.hpp"

namespace trebsweep {

PackSteppers pack_steppers(std::string_view name) {
  return with_pack_stepper(
      name, []<template <class, Effects = Effects{}> class Stepper>() {
        return SteppersByEffects<>::of<Stepper>();
      });
}

}  // namespace trebsweep
