#include "trebsweep/swing/kernel.hpp"

#include "trebsweep/swing/swings.hpp"

namespace trebsweep {
namespace {

/// Registers in a pack: the second hides the first one's latencies, a third would only crowd the
/// first cache.
constexpr std::size_t registers = 2;

}  // namespace

[[gnu::visibility("default")]] std::string_view instruction_set() {
  switch (register_lanes) {
    case 8:
      return "AVX-512 (8 lanes)";
    case 4:
      return "AVX2 with FMA (4 lanes)";
    default:
      return "baseline (2 lanes)";
  }
}

[[gnu::visibility("default")]] Work integrate_packs(const Scene& scene, const Solver& solver,
                                                    const Batch& batch) {
  return with_effects(scene, [&]<Effects E>() {
    return with_pack_stepper(
        solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
          using T = Pack<registers>;
          return swing_all<Stepper<T, E>, T, E>(scene, solver, batch);
        });
  });
}

}  // namespace trebsweep
