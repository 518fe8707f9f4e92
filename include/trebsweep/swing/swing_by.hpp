#pragma once

#include <span>
#include <utility>

#include "trebsweep/swing/swings.hpp"

namespace trebsweep {

/// Integrates one design with effects and a number type chosen at compile time; see swing().
template <class T, Effects E, class Observe = NullObserver>
Outcome<typename Lanes<T>::Number, E> swing_by(const AnyStepper<T, E>& stepper, const Scene& scene,
                                               const Design<double>& design, const Solver& solver,
                                               Observe&& observe = {},
                                               std::span<const Field> fields = {},
                                               std::span<double> values = {}) {
  Outcome<typename Lanes<T>::Number, E> outcome{};
  bool given = false;
  const auto next = [&](Design<double>& d) {
    d = design;
    return !std::exchange(given, true);
  };
  const auto done = [&](std::uint64_t, const auto& o) { outcome = o; };
  Swings<T, E, decltype(next), decltype(done), Observe&> swings(scene, solver, stepper, fields,
                                                                values, next, done, observe);
  swings.run();
  return outcome;
}

}  // namespace trebsweep
