#pragma once

#include <array>
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
struct PlainInstant {
  double t;
  std::array<double, 6> x, directions, dxdt;
};

/// What integrate_packs() reports of a single design besides its SwingResult.
struct ObservedSwing {
  /// Called with the ends of steps; see Swings.
  std::function<void(const PlainInstant& from, const PlainInstant& to)> step;
  // The end of the swing; see Outcome.
  double t = 0, speed = 0;
  std::array<double, 6> x{};
};

/// integrate() for a stepper for packs; fields that are not is_of_swing() stay NaN. `observed`, if
/// not null, is of the only design of the batch.
Work integrate_packs(const Scene& scene, const Solver& solver, const Batch& batch,
                     ObservedSwing* observed = nullptr);

/// The instant one step of length h (s) after `from`, by the stepper for packs of that name.
/// `sliding`: whether the projectile is in the trough.
PlainInstant advance_pack(const Scene& scene, const Design<double>& design,
                          std::string_view stepper, bool sliding, const PlainInstant& from,
                          double h);

}  // namespace trebsweep
