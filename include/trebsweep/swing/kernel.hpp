#pragma once

#include <span>
#include <string_view>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

// This is the library that exists once per instruction set; nothing else is compiled for it.

/// The instruction set of the kernel that the dynamic linker has chosen for this machine, with the
/// number of doubles in a register: "AVX-512 (8 lanes)".
std::string_view instruction_set();

/// Whether an instruction set has the fused multiply-add, which changes last digits.
inline bool has_fma(std::string_view instruction_set) {
  return !instruction_set.starts_with("baseline");
}

/// integrate() for one of pack_stepper_names, and for fields without is_separate().
Work integrate_packs(const Scene& scene, const Solver& solver, const Batch& batch);

}  // namespace trebsweep
