#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "trebsweep/model/scene.hpp"

namespace trebsweep {

/// An axis given by hand, both ends included: first, first + step, ... up to last; metres.
struct AxisRange {
  double first, last, step;
};

/// What a job says of its lattice; the defaults are the paper's. An axis without a range of its own
/// follows the paper's bounds (47)-(49), which are strict.
struct LatticeSpec {
  double increment = 0.01;       ///< dr, m: the step of every axis that is not given by hand
  double shortest_sling = 0.30;  ///< m: where r3 begins (48)
  std::optional<AxisRange> r1, r3, r2;
};

/// A place or an extent in the lattice, counted in steps along (r1, r3, r2).
using Index3 = std::array<std::size_t, 3>;

/// A block of the lattice's box that is computed and written at once.
struct Tile {
  Index3 first, count;

  std::size_t cells() const { return count[0] * count[1] * count[2]; }
};

/// The designs of a job: the box r1 x r3 x r2, less the corner where r2 < h0 - r3 (49) fails.
class Lattice {
 public:
  /// Throws InputError where the scene and the spec leave no design, or more than 1e12 of them.
  Lattice(const Scene& scene, const LatticeSpec& spec);

  /// The values of r1, r3 and r2, m.
  const std::array<std::vector<double>, 3>& axes() const { return axes_; }

  Index3 extent() const { return {axes_[0].size(), axes_[1].size(), axes_[2].size()}; }

  std::uint64_t designs() const;

  /// Whether the cell of the box holds a design.
  bool holds(const Index3& i) const { return i[2] < row_[i[1]]; }

  Design<double> design(const Index3& i) const {
    return {axes_[0][i[0]], axes_[1][i[1]], axes_[2][i[2]]};
  }

  /// How many designs a tile holds.
  std::uint64_t designs_in(const Tile& tile) const;

 private:
  std::array<std::vector<double>, 3> axes_;
  std::vector<std::size_t>
      row_;  // for each r3, how many values of r2 belong to it; never increasing
};

/// The tiles of a lattice that hold at least one design, numbered along r2, then r3, then r1.
class Tiling {
 public:
  /// `edge`: the largest extent of a tile; smaller ones at the upper ends.
  Tiling(const Lattice& lattice, const Index3& edge);

  std::uint64_t size() const;

  Tile tile(std::uint64_t number) const;

  const Index3& edge() const { return edge_; }

 private:
  Index3 extent_, edge_;
  std::vector<std::uint64_t>
      first_in_row_;  // the number of the first tile of each r3 row, and the end
};

}  // namespace trebsweep
