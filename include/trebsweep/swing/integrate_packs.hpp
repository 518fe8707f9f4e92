#pragma once

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/swings.hpp"

namespace trebsweep {

/// Integrates a batch with a stepper, a pack type T and effects chosen at compile time. For
/// `observe`, see Swings.
template <class T, Effects E, class Stepper, class Observe = NullObserver>
Work integrate_by(Stepper& stepper, const Scene& scene, const Solver& solver, const Batch& batch,
                  Observe observe = {}) {
  const auto& [designs, results, fields, values] = batch;
  std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
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
  Swings<Stepper, T, E, decltype(next), decltype(done), Observe> swings(
      scene, solver, stepper, fields, values, next, done, observe);
  const std::uint64_t lane_steps = swings.run();
  return {lane_steps, evaluations(stepper, steps)};
}

/// The packs of adaptive and of fixed-step steppers. Several registers hide the latencies of a
/// fixed step, or those of choosing the length of adaptive steps, which are made register by
/// register.
template <bool adaptive>
using PackFor = Pack<adaptive ? 3 : 2>;

template <bool adaptive, Effects E>
using PackStepper = AnyStepper<PackFor<adaptive>, E, adaptive>;

/// For every combination of effects, a function that returns a stepper for packs.
template <bool adaptive, class = std::make_index_sequence<all_effects.size()>>
struct PackStepperFactories;

template <bool adaptive, std::size_t... I>
struct PackStepperFactories<adaptive, std::index_sequence<I...>> {
  template <std::size_t J>
  using Factory = PackStepper<adaptive, all_effects[J]> (*)(const Solver&);

  std::tuple<Factory<I>...> by_effects;

  template <template <class, Effects> class Stepper>
  static PackStepperFactories of() {
    using T = PackFor<adaptive>;
    return {{any_stepper<T, all_effects[I], Stepper<T, all_effects[I]>>...}};
  }

  template <Effects E>
  PackStepper<adaptive, E> make(const Solver& solver) const {
    return std::get<PackStepper<adaptive, E> (*)(const Solver&)>(by_effects)(solver);
  }
};

template <template <class, Effects> class Stepper>
inline constexpr bool is_adaptive_for_packs = is_adaptive<Stepper<Pack<1>, Effects{}>>;

/// The factories of a stepper. Instantiated in src/swing/kernel/, in one source per stepper, so
/// that they compile in parallel.
template <template <class, Effects> class Stepper>
PackStepperFactories<is_adaptive_for_packs<Stepper>> factories_of() {
  return PackStepperFactories<is_adaptive_for_packs<Stepper>>::template of<Stepper>();
}

/// integrate_packs() with a stepper from such factories. Instantiated in src/swing/kernel/, for all
/// adaptive and for all fixed-step steppers.
template <bool adaptive>
Work integrate_packs_with(const PackStepperFactories<adaptive>& factories, const Scene& scene,
                          const Solver& solver, const Batch& batch) {
  return with_effects(scene, [&]<Effects E>() {
    auto stepper = factories.template make<E>(solver);
    return integrate_by<PackFor<adaptive>, E>(stepper, scene, solver, batch);
  });
}

}  // namespace trebsweep
