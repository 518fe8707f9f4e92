#include "trebsweep/swing/kernel.hpp"

#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

// Defined in adaptive.cpp and fixed.cpp.
extern template Work integrate_packs_with(const PackSteppers<true>&, const Scene&, const Solver&,
                                          const Batch&, ObservedSwing*);
extern template Work integrate_packs_with(const PackSteppers<false>&, const Scene&, const Solver&,
                                          const Batch&, ObservedSwing*);

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
                                                    const Batch& batch, ObservedSwing* observed) {
  return with_pack_stepper(
      solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
        return integrate_packs_with(pack_steppers<Stepper>(), scene, solver, batch, observed);
      });
}

[[gnu::visibility("default")]] PlainInstant advance_pack(const Scene& scene,
                                                         const Design<double>& design,
                                                         std::string_view stepper, bool sliding,
                                                         const PlainInstant& from, double h) {
  return with_pack_stepper(
      stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
        return advance_pack_with(pack_steppers<Stepper>(), scene, design, sliding, from, h);
      });
}

}  // namespace trebsweep
