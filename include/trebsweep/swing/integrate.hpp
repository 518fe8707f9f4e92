#pragma once

#include <span>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// Integrates designs, many at a time where the stepper can; shots[i] is that of designs[i], to the
/// bit whatever its neighbours are, and values[i fields.size() + f] its field f, NaN where it has
/// none. Speed, release time, status and steps are in the shots, not among `fields`. The share of
/// the shots' steps in the lanes' is the lanes' utilisation.
Work integrate(const Scene& scene, const Solver& solver, const Batch& batch);

/// A solver that is accurate to about 1e-11 m/s in scenes like the paper's, with another's limits.
Solver accurate(Solver solver);

}  // namespace trebsweep
