#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "trebsweep/field.hpp"
#include "trebsweep/scene.hpp"
#include "trebsweep/solver.hpp"
#include "trebsweep/status.hpp"

namespace trebsweep {

/// What a map keeps of a design.
struct Shot {
  double speed;         ///< m/s, NaN without a release
  double release_time;  ///< s, NaN without a release
  std::uint64_t steps;  ///< tried
  Status status;
};

/// The instruction set of the kernel that the dynamic linker has chosen for this machine, with the
/// number of doubles in a register: "AVX-512 (8 lanes)".
std::string_view instruction_set();

/// Integrates designs, many at a time; shots[i] is that of designs[i], to the bit whatever its
/// neighbours are, and values[i fields.size() + f] its field f, NaN without a release. Speed,
/// release time, status and steps are in the shots, not among `fields`. Returns how many steps
/// lanes have made, idle ones included: the share of the shots' steps in it is the lanes'
/// utilisation.
///
/// This is the library that exists once per instruction set; nothing else is compiled for it.
std::uint64_t integrate(const Scene& scene, const Solver& solver,
                        std::span<const Design<double>> designs, std::span<const Field> fields,
                        std::span<Shot> shots, std::span<double> values);

}  // namespace trebsweep
