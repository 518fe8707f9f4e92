#pragma once

#include <functional>
#include <span>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/outcome.hpp"

namespace trebsweep {

/// Called with the ends of every accepted step, except the last one of a swing without a release.
/// The last step of a released swing ends at the release.
template <Effects E>
using Observer = std::function<void(const Instant<double, E>& from, const Instant<double, E>& to)>;

/// Integrates one design in double precision by the solver's stepper, any of the registry. E must
/// be the effects of the scene. If the design has a release, values[i] is set to fields[i]; see
/// Batch.
template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe = {}, std::span<const Field> fields = {},
                         std::span<double> values = {});

}  // namespace trebsweep
