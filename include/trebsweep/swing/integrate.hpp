#pragma once

#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {

/// Integrates a batch, in packs if the stepper serves them. The result of a design is bitwise
/// independent of the rest of the batch. A field without a value is NaN. The utilisation of the
/// lanes is the sum of the results' steps over Work::lane_steps.
Work integrate(const Scene& scene, const Solver& solver, const Batch& batch);

/// The same, but fields that are not is_of_swing() stay NaN. `observed` may be null, or receives
/// the steps of the batch's single design.
Work integrate_swings(const Scene& scene, const Solver& solver, const Batch& batch,
                      ObservedSwing* observed = nullptr);

/// The solver with another stepper, to check results by integrate_accurately(): with vern8 or, if
/// that is to be checked, fehlberg78, or dopri5 in scenes with an elastic sling.
Solver checking_solver(const Scene& scene, const Solver& solver);

/// Integrates a batch far more accurately than a job does: to the located() release, by the
/// solver's stepper, which is adaptive, at a tolerance of 1e-13. A swing whose steps underflow or
/// exceed 100,000 is integrated again at 1e-12, 1e-11 and at last 1e-10. By vern8 and by the
/// steppers of checking_solver(), the errors of speeds are below 1e-11 m/s on the paper's lattice,
/// and below 1e-8 m/s where an elastic sling goes slack; other quantities, loads included, have
/// relative errors below 1e-11 in typical scenes.
void integrate_accurately(const Scene& scene, const Solver& solver, const Batch& batch);

}  // namespace trebsweep
