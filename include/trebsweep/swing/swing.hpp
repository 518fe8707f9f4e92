#pragma once

#include "trebsweep/swing/outcome.hpp"
#include "trebsweep/swing/plain_instant.hpp"

namespace trebsweep {

/// Integrates one design by the solver's stepper, any of the registry. If the design has a release,
/// values[i] is set to fields[i]; see Batch. Calls observed.step, if it is not empty, with the ends
/// of every accepted step, except the last one of a swing without a release; the last step of a
/// released swing ends at the release.
SwingResult swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                  ObservedSwing& observed, std::span<const Field> fields = {},
                  std::span<double> values = {});

/// Called with the ends of steps.
template <Effects E>
using Observer = std::function<void(const Instant<double, E>& from, const Instant<double, E>& to)>;

/// The same, for a scene with the effects E.
template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe = {}, std::span<const Field> fields = {},
                         std::span<double> values = {}) {
  ObservedSwing observed;
  if (observe)
    observed.step = [&](const PlainInstant& from, const PlainInstant& to) {
      observe(to_instant<double, E>(from), to_instant<double, E>(to));
    };
  const SwingResult result = swing(scene, design, solver, observed, fields, values);
  Outcome<double, E> outcome{result.status, observed.t, {}, observed.speed, result.steps};
  std::copy_n(observed.x.begin(), outcome.x.size(), outcome.x.begin());
  return outcome;
}

}  // namespace trebsweep
