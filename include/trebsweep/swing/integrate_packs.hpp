#pragma once

#include <algorithm>
#include <limits>

#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/plain_instant.hpp"
#include "trebsweep/swing/swings.hpp"

namespace trebsweep {

/// Integrates a batch with a pack type T and effects chosen at compile time. For `observe`, see
/// Swings.
template <class T, Effects E, class Observe = NullObserver>
Work integrate_by(const AnyStepper<T, E>& stepper, const Scene& scene, const Solver& solver,
                  const Batch& batch, Observe observe = {}) {
  std::fill(batch.values.begin(), batch.values.end(), std::numeric_limits<double>::quiet_NaN());
  std::size_t at = 0;
  const auto next = [&](Design<double>& design) {
    if (at == batch.designs.size()) return false;
    design = batch.designs[at++];
    return true;
  };
  std::uint64_t steps = 0;
  const auto done = [&](std::uint64_t index, const auto& outcome) {
    steps += outcome.steps;
    if constexpr (requires { observe.end(outcome); }) observe.end(outcome);
    batch.results[index] = result_of(outcome, batch.slice(index, 1).values);
  };
  Swings<T, E, decltype(next), decltype(done), Observe> swings(scene, solver, stepper, batch.fields,
                                                               batch.values, next, done, observe);
  const std::uint64_t lane_steps = swings.run();
  return {lane_steps, info_of_stepper(solver.stepper).stages * steps};
}

/// Reports the steps and the end of the swing in the first lane, if somebody observes it.
class SwingReporter {
 public:
  explicit SwingReporter(ObservedSwing* observed) : observed_(observed) {}

  explicit operator bool() const { return observed_ && observed_->step; }

  template <class T, Effects E>
  void operator()(const Instant<T, E>& from, const Instant<T, E>& to) const {
    observed_->step(to_plain(from), to_plain(to));
  }

  template <Effects E>
  void end(const Outcome<double, E>& outcome) const {
    if (!observed_) return;
    observed_->t = outcome.t;
    observed_->speed = outcome.speed;
    std::copy(outcome.x.begin(), outcome.x.end(), observed_->x.begin());
  }

 private:
  ObservedSwing* observed_;
};

}  // namespace trebsweep
