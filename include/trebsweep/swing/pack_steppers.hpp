#pragma once

#include <string_view>
#include <tuple>
#include <utility>

#include "trebsweep/ode/any_stepper.hpp"

namespace trebsweep {

/// The packs of the kernel. Several registers hide the latencies of fixed steps, and those of
/// choosing the length of adaptive ones, which are made register by register.
using KernelPack = Pack<3>;

template <class = std::make_index_sequence<all_effects.size()>>
struct SteppersByEffects;

template <std::size_t... I>
struct SteppersByEffects<std::index_sequence<I...>> {
  using type = std::tuple<AnyStepper<KernelPack, all_effects[I]>...>;

  template <template <class, Effects> class Stepper>
  static type of() {
    return {any_stepper<KernelPack, all_effects[I], Stepper<KernelPack, all_effects[I]>>()...};
  }
};

/// A stepper for packs, for every combination of effects.
using PackSteppers = SteppersByEffects<>::type;

/// The stepper for packs of that name. Throws std::logic_error if it is not such a stepper.
PackSteppers pack_steppers(std::string_view name);

}  // namespace trebsweep
