#pragma once

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

/// integrate() for a stepper for packs, and for fields that are not is_separate().
Work integrate_packs(const Scene& scene, const Solver& solver, const Batch& batch);

}  // namespace trebsweep
