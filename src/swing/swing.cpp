#include "trebsweep/swing/swing.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/plain_instant.hpp"

namespace trebsweep {
namespace {

template <Effects E>
Outcome<double, E> swing_once(const Scene& scene, const Design<double>& design,
                              const Solver& solver, const Observer<E>& observe,
                              std::span<const Field> fields, std::span<double> values) {
  ObservedSwing observed;
  if (observe)
    observed.step = [&](const PlainInstant& from, const PlainInstant& to) {
      observe(to_instant<double, E>(from), to_instant<double, E>(to));
    };
  SwingResult result;
  integrate_swings(scene, solver, {{&design, 1}, {&result, 1}, fields, values}, &observed);
  Outcome<double, E> outcome{result.status, observed.t, {}, observed.speed, result.steps};
  std::copy_n(observed.x.begin(), outcome.x.size(), outcome.x.begin());
  return outcome;
}

}  // namespace

template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe, std::span<const Field> fields,
                         std::span<double> values) {
  if (!observe || !takes_best_moment(solver.release))
    return swing_once(scene, design, solver, observe, fields, values);
  // The release is chosen from an interval: steps that follow it are left out.
  struct Step {
    Instant<double, E> from, to;
  };
  std::vector<Step> taken;
  const auto outcome = swing_once<E>(
      scene, design, solver,
      [&](const Instant<double, E>& from, const Instant<double, E>& to) {
        taken.push_back({from, to});
      },
      fields, values);
  for (const Step& step : taken) {
    // Times of fixed steps differ by rounding errors.
    const bool is_last =
        std::abs(step.from.t - taken.back().from.t) <= (step.to.t - step.from.t) / 2;
    observe(step.from, is_last ? taken.back().to : step.to);
    if (is_last) break;
  }
  return outcome;
}

static_assert(general_effects.size() == 5);
template Outcome<double, general_effects[0]> swing(const Scene&, const Design<double>&,
                                                   const Solver&,
                                                   const Observer<general_effects[0]>&,
                                                   std::span<const Field>, std::span<double>);
template Outcome<double, general_effects[1]> swing(const Scene&, const Design<double>&,
                                                   const Solver&,
                                                   const Observer<general_effects[1]>&,
                                                   std::span<const Field>, std::span<double>);
template Outcome<double, general_effects[2]> swing(const Scene&, const Design<double>&,
                                                   const Solver&,
                                                   const Observer<general_effects[2]>&,
                                                   std::span<const Field>, std::span<double>);
template Outcome<double, general_effects[3]> swing(const Scene&, const Design<double>&,
                                                   const Solver&,
                                                   const Observer<general_effects[3]>&,
                                                   std::span<const Field>, std::span<double>);
template Outcome<double, general_effects[4]> swing(const Scene&, const Design<double>&,
                                                   const Solver&,
                                                   const Observer<general_effects[4]>&,
                                                   std::span<const Field>, std::span<double>);

}  // namespace trebsweep
