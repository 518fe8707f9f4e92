#pragma once

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/plain_instant.hpp"
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
    if constexpr (requires { observe.end(outcome); }) observe.end(outcome);
    results[index] = result_of(outcome, values.subspan(index * fields.size(), fields.size()));
  };
  Swings<Stepper, T, E, decltype(next), decltype(done), Observe> swings(
      scene, solver, stepper, fields, values, next, done, observe);
  const std::uint64_t lane_steps = swings.run();
  return {lane_steps, info_of_stepper(solver.stepper).stages * steps};
}

/// The packs of adaptive and of fixed-step steppers. Several registers hide the latencies of a
/// fixed step, or those of choosing the length of adaptive steps, which are made register by
/// register.
template <bool adaptive>
using PackFor = Pack<adaptive ? 3 : 2>;

template <bool adaptive, Effects E>
using PackStepper = AnyStepper<PackFor<adaptive>, E, adaptive>;

/// A stepper for packs, for every combination of effects.
template <bool adaptive, class = std::make_index_sequence<all_effects.size()>>
struct PackSteppers;

template <bool adaptive, std::size_t... I>
struct PackSteppers<adaptive, std::index_sequence<I...>> {
  std::tuple<PackStepper<adaptive, all_effects[I]>...> by_effects;

  template <template <class, Effects> class Stepper>
  static PackSteppers of() {
    using T = PackFor<adaptive>;
    return {{any_stepper<T, all_effects[I], Stepper<T, all_effects[I]>>()...}};
  }
};

template <template <class, Effects> class Stepper>
inline constexpr bool is_adaptive_for_packs = is_adaptive<Stepper<Pack<1>, Effects{}>>;

/// Those of a method.
template <template <class, Effects> class Stepper>
PackSteppers<is_adaptive_for_packs<Stepper>> pack_steppers() {
  return PackSteppers<is_adaptive_for_packs<Stepper>>::template of<Stepper>();
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

/// integrate_packs() with one of such steppers. Instantiated in src/swing/kernel/, for all adaptive
/// and for all fixed-step steppers.
template <bool adaptive>
Work integrate_packs_with(const PackSteppers<adaptive>& steppers, const Scene& scene,
                          const Solver& solver, const Batch& batch, ObservedSwing* observed) {
  return with_effects(scene, [&]<Effects E>() {
    auto stepper = std::get<PackStepper<adaptive, E>>(steppers.by_effects);
    return integrate_by<PackFor<adaptive>, E>(stepper, scene, solver, batch,
                                              SwingReporter(observed));
  });
}

/// advance_pack() with one of such steppers.
template <bool adaptive>
PlainInstant advance_pack_with(const PackSteppers<adaptive>& steppers, const Scene& scene,
                               const Design<double>& design, bool sliding, const PlainInstant& from,
                               double h) {
  return with_effects(scene, [&]<Effects E>() {
    using T = PackFor<adaptive>;
    auto stepper = std::get<PackStepper<adaptive, E>>(steppers.by_effects);
    Motion<T, E> motion(scene, {T(design.r1), T(design.r3), T(design.r2)});
    motion.set_sliding(T(sliding ? 1 : 0));
    Instant<T, E> to;
    State<T, E> error;
    stepper.step(motion, to_instant<T, E>(from), T(h), to, error);
    return to_plain(to);
  });
}

}  // namespace trebsweep
