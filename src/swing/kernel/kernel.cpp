#include "trebsweep/swing/kernel.hpp"

#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep {

// Defined in the source of each stepper.
extern template Work integrate_packs_by<Euler>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<ModifiedMidpoint>(const Scene&, const Solver&,
                                                          const Batch&);
extern template Work integrate_packs_by<RungeKutta4>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<CashKarp54>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<Dopri5>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<Fehlberg78>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<Vern7>(const Scene&, const Solver&, const Batch&);
extern template Work integrate_packs_by<Vern8>(const Scene&, const Solver&, const Batch&);

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
        return integrate_packs_by<Stepper>(scene, solver, batch);
      });
}

}  // namespace trebsweep
