#include "trebsweep/swing/kernel.hpp"

#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

// Defined in the source of each stepper.
extern template PackStepperFactories<true> factories_of<CashKarp54>();
extern template PackStepperFactories<true> factories_of<Dopri5>();
extern template PackStepperFactories<false> factories_of<Euler>();
extern template PackStepperFactories<true> factories_of<Fehlberg78>();
extern template PackStepperFactories<false> factories_of<ModifiedMidpoint>();
extern template PackStepperFactories<false> factories_of<RungeKutta4>();
extern template PackStepperFactories<true> factories_of<Vern7>();
extern template PackStepperFactories<true> factories_of<Vern8>();
// Defined in adaptive.cpp and fixed.cpp.
extern template Work integrate_packs_with(const PackStepperFactories<true>&, const Scene&,
                                          const Solver&, const Batch&);
extern template Work integrate_packs_with(const PackStepperFactories<false>&, const Scene&,
                                          const Solver&, const Batch&);

[[gnu::visibility("default")]] std::string_view instruction_set() {
  if (!has_fused_multiply_add) return "baseline (2 lanes)";
  switch (register_lanes) {
    case 8:
      return "AVX-512 (8 lanes)";
    case 4:
      return "AVX2 with FMA (4 lanes)";
    default:
      return "generic with FMA (2 lanes)";
  }
}

[[gnu::visibility("default")]] Work integrate_packs(const Scene& scene, const Solver& solver,
                                                    const Batch& batch) {
  return with_pack_stepper(
      solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
        return integrate_packs_with(factories_of<Stepper>(), scene, solver, batch);
      });
}

}  // namespace trebsweep
