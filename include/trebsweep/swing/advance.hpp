#pragma once

#include <functional>

#include "trebsweep/swing/plain_instant.hpp"

namespace trebsweep {

/// The solver's stepper for a design, if it is one that integrates one design at a time.
SingleStepper single_stepper(const Scene& scene, const Design<double>& design,
                             const Solver& solver);

/// The instant a step of length h (s) after `from`. A multistep stepper keeps its history from call
/// to call.
using PlainAdvance = std::function<PlainInstant(bool sliding, const PlainInstant& from, double h)>;

/// That of the solver's stepper, any of the registry, for a design. Those for packs step in the
/// kernel, with the bits of a lattice's designs.
PlainAdvance plain_advance(const Scene& scene, const Design<double>& design, const Solver& solver);

/// The same with states of the effects E: advance(motion, from, h), with the design's motion.
template <Effects E>
using Advance = std::function<Instant<double, E>(const Motion<double, E>& motion,
                                                 const Instant<double, E>& from, double h)>;

/// plain_advance() as such a function; E must be the effects of the scene.
template <Effects E>
Advance<E> make_advance(const Scene& scene, const Design<double>& design, const Solver& solver) {
  return [advance = plain_advance(scene, design, solver)](
             const Motion<double, E>& motion, const Instant<double, E>& from, double h) {
    return to_instant<double, E>(advance(is_sliding(motion), to_plain(from), h));
  };
}

}  // namespace trebsweep
