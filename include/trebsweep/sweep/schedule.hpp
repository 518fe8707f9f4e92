#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// The extent of a lattice's tiles: about a fifth of the lattice along each axis, which gives
/// enough tiles to share among ranks but few to write. Longer along an axis where the others are
/// short, if there are many scenes, and without maps; shorter where designs are slow, so that a
/// tile takes at most about a second of one core, up to some million tiles. `extent` is that of the
/// box of each of the `scenes`, and `design_seconds` the time to integrate a design.
Index3 tile_edge(const Index3& extent, std::uint64_t scenes, Maps maps, double design_seconds);

/// The number of items to process next in about `target` seconds, if the last `count` took
/// `seconds`. At least 1. Grows at most eightfold and shrinks at most tenfold, since short times
/// are unreliable.
std::uint64_t next_count(std::uint64_t count, double seconds, double target);

}  // namespace trebsweep
