#pragma once

#include <functional>

#include "trebsweep/ode/instant.hpp"
#include "trebsweep/ode/solver.hpp"

namespace trebsweep {

/// advance(motion, from, h) is the instant a step of length h after `from`. A multistep stepper
/// keeps its history from call to call.
template <class T, Effects E>
using Advance =
    std::function<Instant<T, E>(const Motion<T, E>& motion, const Instant<T, E>& from, const T& h)>;

/// The same for any stepper of the registry. T is double, or long double if the stepper supports
/// packs; E is one of general_effects. Throws std::logic_error for others.
template <class T, Effects E>
Advance<T, E> make_advance(const Solver& solver);

}  // namespace trebsweep
