#pragma once

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

/// Integrates a batch, in packs if the stepper serves them. The result of a design is bitwise
/// independent of the rest of the batch. A field without a value is NaN. The utilisation of the
/// lanes is the sum of the results' steps over Work::lane_steps.
Work integrate(const Scene& scene, const Solver& solver, const Batch& batch);

/// fehlberg78 at a tolerance of 1e-12, with the limits of `limits`: errors below 1e-11 m/s on the
/// paper's lattice.
Solver accurate(const Solver& limits);

}  // namespace trebsweep
