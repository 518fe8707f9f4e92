#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/model/scene.hpp"

namespace trebsweep {

/// An explicit axis: first, first + step, ..., last, both ends included; metres.
struct AxisRange {
  double first, last, step;
};

/// The lattice of a job; the defaults are the paper's. An axis without an explicit range has the
/// paper's bounds (47)-(49), which are strict. Under (48) and (49) no sling reaches a trough on the
/// ground.
struct LatticeSpec {
  double increment = 0.01;       ///< dr, m: the step of every axis that is not explicit
  double shortest_sling = 0.30;  ///< m: the smallest r3 (48)
  std::optional<AxisRange> r1, r3, r2;
};

/// The strict bounds of r1 (47), m, and their formulas: "h - h0", "h0".
struct ArmBounds {
  double low, high;
  std::string low_text, high_text;
};

/// The arm must be long enough to hold the counterweight at the start height, unless the scene
/// gives the start angle, and so short that the counterweight, hanging below it, clears the ground.
ArmBounds arm_bounds(const Scene& scene);

/// The default axis of r3 and r2 in scenes with a trough, to which the sling must reach down:
/// around the heights of their fulcrums (m), in whole steps.
AxisRange trough_axis(double lowest, double highest, double step);

/// The lattice of scenes with a trough, in which an axis r3 or r2 that is not explicit has that
/// default; without an increment from the job its step is coarse.
LatticeSpec with_trough_axes(LatticeSpec spec, bool has_increment, double lowest, double highest);

/// An index or an extent in the lattice along (r1, r3, r2).
using Index3 = std::array<std::size_t, 3>;

/// The values of r1, r3 and r2, m, ascending.
using LatticeAxes = std::array<std::vector<double>, 3>;

/// A block of a lattice's box.
struct Block {
  Index3 first, count;

  std::size_t cells() const { return count[0] * count[1] * count[2]; }
};

/// The designs of a scene: the box r1 x r3 x r2 without the corner where r2 < h0 - r3 (49) fails.
///
/// The axes are in the order r1, r3, r2: that of the paper's nested loops, in which the bound of r2
/// depends on r3, and that of storage, in which r2 varies fastest.
class Lattice {
 public:
  /// Throws InputError if the scene and the spec allow no design, or if the box has more than 1e12
  /// cells. In a scene with a trough r3 and r2 must be explicit: with_trough_axes().
  Lattice(const Scene& scene, const LatticeSpec& spec);

  /// Extends the box, in which the lattice keeps its designs. `box` must hold the values of the
  /// lattice's own, and may have others in between; its r3 and r2 must start with the lattice's.
  void extend_to(std::shared_ptr<const LatticeAxes> box);

  /// The axes of the box.
  const LatticeAxes& axes() const { return *axes_; }

  Index3 extent() const { return {axes()[0].size(), axes()[1].size(), axes()[2].size()}; }

  std::uint64_t designs() const;

  /// Whether a cell of the box holds a design.
  bool holds(const Index3& i) const {
    return i[2] < row_length_[i[1]] && std::ranges::binary_search(r1_, i[0]);
  }

  /// The indices in the box of the values of r1 that designs have, ascending.
  const std::vector<std::size_t>& r1_indices() const { return r1_; }

  /// The number of designs along r2 at the r3 with index i3, for every r1 that designs have. They
  /// are the first cells of their row.
  std::size_t row_length(std::size_t i3) const { return row_length_[i3]; }

  Design<double> design(const Index3& i) const {
    return {axes()[0][i[0]], axes()[1][i[1]], axes()[2][i[2]]};
  }

  /// The index of a design of the lattice.
  Index3 index_of(const Design<double>& design) const;

  /// The number of designs in a block.
  std::uint64_t designs_in(const Block& block) const;

 private:
  std::shared_ptr<const LatticeAxes> axes_;  // shared by lattices in a common box
  std::vector<std::size_t> r1_;              // the indices in the box of the designs' r1
  // The number of designs along r2 at each r3, in non-increasing order.
  std::vector<std::size_t> row_length_;
};

}  // namespace trebsweep
