#include "trebsweep/kernel.hpp"

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
                                                       std::span<Shot> shots) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::size_t at = 0;
  const auto next = [&](Design<double>& design) {
    if (at == designs.size()) return false;
    design = designs[at++];
    return true;
  };
  const auto done = [&](std::uint64_t number, const Outcome<double>& outcome) {
    const bool released = outcome.status == Status::released;
    shots[number] = {released ? outcome.speed : nan, released ? outcome.t : nan, outcome.steps,
                     outcome.status};
  };
  return with_stepper(solver.stepper, [&]<template <class> class Stepper>() {
    using T = Pack<registers>;
    return Swings<Stepper<T>, T, decltype(next), decltype(done)>(scene, solver, next, done).run();
  });
}

}  // namespace trebsweep
