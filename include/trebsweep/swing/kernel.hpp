#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/batch.hpp"

namespace trebsweep {

// The interface of the kernel library, the only code that is compiled once per instruction set.

/// The instruction set of the kernel library that the dynamic linker has chosen for this machine,
/// with the number of doubles in a register, for example "AVX-512 (8 lanes)".
std::string_view instruction_set();

/// Whether an instruction_set() has a fused multiply-add, which changes last digits.
inline bool has_fma(std::string_view instruction_set) {
  return !instruction_set.starts_with("baseline");
}

/// An instant of a swing in any scene; see Instant. Of the arrays, a scene uses the first elements.
using PlainState = std::array<double, 6>;
struct PlainInstant {
  double t;
  PlainState x, directions, dxdt;
};

/// The outcome of a step; see Trial.
struct PlainTrial {
  PlainInstant to;
  bool accepted;
  double next;
};

/// A stepper that integrates one design at a time, with a state of its own. `sliding`: whether the
/// projectile is in the trough.
struct SingleStepper {
  // See AnyStepper.
  bool adaptive, interpolated;
  int order, error_order;
  std::function<PlainInstant(bool sliding, const PlainInstant& from, double h, PlainState& error)>
      step;
  std::function<PlainTrial(bool sliding, const PlainInstant& from, double h)> try_step;
  /// Evaluations of the right-hand side so far.
  std::function<std::uint64_t()> evaluations;
};

/// What integrate_packs() reports of a single design besides its SwingResult.
struct ObservedSwing {
  /// Called with the ends of steps; see Swings.
  std::function<void(const PlainInstant& from, const PlainInstant& to)> step;
  // The end of the swing; see Outcome.
  double t = 0, speed = 0;
  PlainState x{};
};

/// integrate() for a stepper for packs; fields that are not is_of_swing() stay NaN. Of a batch with
/// a single design, `observed` receives the steps, and `single` takes the place of the solver's
/// stepper; both may be null.
Work integrate_packs(const Scene& scene, const Solver& solver, const Batch& batch,
                     ObservedSwing* observed = nullptr, const SingleStepper* single = nullptr);

/// The instant one step of length h (s) after `from`, by the stepper for packs of that name.
PlainInstant advance_pack(const Scene& scene, const Design<double>& design,
                          std::string_view stepper, bool sliding, const PlainInstant& from,
                          double h);

}  // namespace trebsweep
