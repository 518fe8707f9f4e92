#include "trebsweep/swing/swing.hpp"

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/ode/bulirsch_stoer.hpp"
#include "trebsweep/swing/swing_by.hpp"

namespace trebsweep {

template <Effects E>
Outcome<double, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                         const Observer<E>& observe, std::span<const Field> fields,
                         std::span<double> values) {
  const auto observe_if_given = [&](const Instant<double, E>& from, const Instant<double, E>& to) {
    if (observe) observe(from, to);
  };
  const auto swing_with = [&](auto&& stepper) {
    return swing_by<double, E>(stepper, scene, design, solver, observe_if_given, fields, values);
  };
  if (info_of_stepper(solver.stepper).id == StepperId::bulirsch_stoer)
    return swing_with(BulirschStoer<double, E>(solver));
  if (follows_tolerance(solver.stepper))
    return swing_with(make_any_stepper<double, E, true>(solver));
  return swing_with(make_any_stepper<double, E, false>(solver));
}

static_assert(all_effects.size() == 10);
template Outcome<double, all_effects[0]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[0]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[1]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[1]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[2]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[2]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[3]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[3]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[4]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[4]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[5]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[5]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[6]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[6]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[7]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[7]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[8]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[8]>&,
                                               std::span<const Field>, std::span<double>);
template Outcome<double, all_effects[9]> swing(const Scene&, const Design<double>&, const Solver&,
                                               const Observer<all_effects[9]>&,
                                               std::span<const Field>, std::span<double>);

}  // namespace trebsweep
