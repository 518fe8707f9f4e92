#pragma once

#include <array>
#include <optional>
#include <stdexcept>
#include <string>

#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

/// There is no optimum, and why. The program exits with code 1.
struct NoOptimum : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The continuous region that a lattice samples, closed: the designs with lower <= (r1, r3, r2) <=
/// upper (m) and, unless the axis r2 is explicit, r2 + r3 <= h0 (49). The ends of a fixed length
/// are equal.
struct DesignSpace {
  std::array<double, 3> lower, upper;
  std::optional<double> longest_sum;  ///< h0, m
};

inline constexpr std::array<const char*, 3> length_names{"r1", "r3", "r2"};

/// A design as the array (r1, r3, r2).
inline std::array<double, 3> lengths(const Design<double>& design) {
  return {design.r1, design.r3, design.r2};
}

/// The design of such an array.
inline Design<double> to_design(const std::array<double, 3>& r) {
  return {.r1 = r[0], .r3 = r[1], .r2 = r[2]};
}

/// A design whose lengths differ by a multiple of (r1, r3, r2), m.
inline Design<double> moved(const Design<double>& design, const std::array<double, 3>& by,
                            double multiple = 1) {
  return {.r1 = design.r1 + multiple * by[0],
          .r3 = design.r3 + multiple * by[1],
          .r2 = design.r2 + multiple * by[2]};
}

/// The design to 0.1 micrometres: "r1 = 0.5114230, r2 = 0.9166028, r3 = 0.5833972 m".
std::string to_text(const Design<double>& design);

/// The region of a lattice. Throws NoOptimum if it is empty.
DesignSpace design_space(const Scene& scene, const LatticeSpec& spec);

}  // namespace trebsweep
