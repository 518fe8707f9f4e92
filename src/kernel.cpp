#include "trebsweep/kernel.hpp"

#include <algorithm>
#include <limits>

#include "trebsweep/swing.hpp"

namespace trebsweep {
namespace {

/// Registers in a pack: the second hides the first one's latencies, a third would only crowd the
/// first cache.
constexpr std::size_t registers = 2;

}  // namespace

[[gnu::visibility("default")]] std::string_view instruction_set() {
  switch (register_lanes) {
    case 8:
      return "AVX-512 (8 lanes)";
    case 4:
      return "AVX2 with FMA (4 lanes)";
    default:
      return "baseline (2 lanes)";
  }
}

[[gnu::visibility("default")]] std::uint64_t integrate(const Scene& scene, const Solver& solver,
                                                       std::span<const Design<double>> designs,
                                                       std::span<const Field> fields,
                                                       std::span<Shot> shots,
                                                       std::span<double> values) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::fill(values.begin(), values.end(), nan);
  std::size_t at = 0;
  const auto next = [&](Design<double>& design) {
    if (at == designs.size()) return false;
    design = designs[at++];
    return true;
  };
  const auto done = [&](std::uint64_t number, const auto& outcome) {
    const bool shot = is_shot(outcome.status);
    shots[number] = {shot ? outcome.speed : nan, shot ? outcome.t : nan, outcome.steps,
                     outcome.status};
    if (!shot) std::fill_n(values.begin() + number * fields.size(), fields.size(), nan);
  };
  return with_effects(scene, [&]<Effects E>() {
    return with_stepper(
        solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
          using T = Pack<registers>;
          return Swings<Stepper<T, E>, T, E, decltype(next), decltype(done)>(scene, solver, fields,
                                                                             values, next, done)
              .run();
        });
  });
}

}  // namespace trebsweep
