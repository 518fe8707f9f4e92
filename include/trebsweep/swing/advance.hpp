#pragma once

#include <functional>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

/// advance(motion, from, h) is the instant a step of length h (s) after `from`. A multistep stepper
/// keeps its history from call to call.
template <Effects E>
using Advance = std::function<Instant<double, E>(const Motion<double, E>& motion,
                                                 const Instant<double, E>& from, double h)>;

/// The same for the solver's stepper, any of the registry; `motion` must be that of the design.
/// Those for packs step in the kernel, with the bits of a lattice's designs. E is one of
/// general_effects.
template <Effects E>
Advance<E> make_advance(const Scene& scene, const Design<double>& design, const Solver& solver);

}  // namespace trebsweep
