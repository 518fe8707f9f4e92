#include "trebsweep/swing/swing.hpp"

#include <vector>

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/ode/bulirsch_stoer.hpp"
#include "trebsweep/swing/swing_by.hpp"

namespace trebsweep {

namespace {

template <Effects E>
struct Step {
  Instant<double, E> from, to;
};

}  // namespace

template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe, std::span<const Field> fields,
                         std::span<double> values) {
  // By rules that choose the release from an interval, steps follow it. They are left out.
  const bool choosing = takes_best_moment(solver.release);
  std::vector<Step<E>> taken;
  const auto observe_if_given = [&](const Instant<double, E>& from, const Instant<double, E>& to) {
    if (!observe) return;
    if (choosing)
      taken.push_back({from, to});
    else
      observe(from, to);
  };
  const auto swing_with = [&](auto&& stepper) {
    return swing_by<double, E>(stepper, scene, design, solver, observe_if_given, fields, values);
  };
  const auto outcome = info_of_stepper(solver.stepper).id == StepperId::bulirsch_stoer
                           ? swing_with(BulirschStoer<double, E>(solver))
                       : follows_tolerance(solver.stepper)
                           ? swing_with(make_any_stepper<double, E, true>(solver))
                           : swing_with(make_any_stepper<double, E, false>(solver));
  for (const Step<E>& step : taken)
    if (&step == &taken.back() || step.from.t < taken.back().from.t) observe(step.from, step.to);
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
