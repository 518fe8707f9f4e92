#pragma once

#include <algorithm>
#include <limits>

#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/swings.hpp"

namespace trebsweep {

/// Integrates a batch with a stepper, a pack type T and effects chosen at compile time.
template <class Stepper, class T, Effects E>
Work integrate_by(const Scene& scene, const Solver& solver, const Batch& batch) {
  const auto& [designs, results, fields, values] = batch;
  std::ranges::fill(values, std::numeric_limits<double>::quiet_NaN());
  std::size_t at = 0;
  const auto next = [&, &designs = designs](Design<double>& design) {
    if (at == designs.size()) return false;
    design = designs[at++];
    return true;
  };
  std::uint64_t steps = 0;
  const auto done = [&, &results = results, &fields = fields, &values = values](
                        std::uint64_t index, const auto& outcome) {
    steps += outcome.steps;
    results[index] = result_of(outcome, values.subspan(index * fields.size(), fields.size()));
  };
  Swings<Stepper, T, E, decltype(next), decltype(done)> swings(scene, solver, fields, values, next,
                                                               done);
  const std::uint64_t lane_steps = swings.run();
  return {lane_steps, evaluations(swings.stepper(), steps)};
}

/// Registers in a pack: several hide the latencies of a fixed step, or those of choosing the length
/// of adaptive steps, which are made register by register.
template <template <class, Effects> class Stepper>
inline constexpr std::size_t registers_per_pack = is_adaptive<Stepper<Pack<1>, Effects{}>> ? 3 : 2;

/// integrate_packs() for one stepper. Instantiated in src/swing/kernel/, in one source per stepper,
/// so that they compile in parallel.
template <template <class, Effects> class Stepper>
Work integrate_packs_by(const Scene& scene, const Solver& solver, const Batch& batch) {
  using T = Pack<registers_per_pack<Stepper>>;
  return with_effects(
      scene, [&]<Effects E>() { return integrate_by<Stepper<T, E>, T, E>(scene, solver, batch); });
}

}  // namespace trebsweep
