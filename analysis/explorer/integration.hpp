#pragma once

#include <vector>

#include "job_keys.hpp"
#include "trebsweep/swing/integrate_packs.hpp"

namespace trebsweep::explorer {

/// One register per number: SIMD128 has sixteen, as many as a step needs for its temporaries.
using Number = Pack<1>;

template <Effects E>
using Moment = Instant<Number, E>;

template <Effects E>
struct Step {
  Moment<E> from, to;
};

/// An observer that collects the steps of a single design, if they are wanted.
template <Effects E>
struct Recorder {
  std::vector<Step<E>>* steps;

  explicit operator bool() const { return steps != nullptr; }
  void operator()(const Moment<E>& from, const Moment<E>& to) const {
    steps->push_back({from, to});
  }
};

/// AnyStepper keeps the module small: a step is compiled once, not in each place that takes one.
template <Effects E>
auto make_stepper() {
  return any_stepper<Number, E, Vern8<Number, E>>();
}

/// Integrates a batch by the job; `steps`, if not null, receives those of a single design.
template <Effects E>
void integrate_batch(const Batch& batch, std::vector<Step<E>>* steps) {
  integrate_by(make_stepper<E>(), scene, solver, batch, Recorder<E>{steps});
}

}  // namespace trebsweep::explorer
