#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// A tile and its number in the Tiling.
struct NumberedTile {
  std::uint64_t number;
  Tile tile;
};

/// The extent of a lattice's tiles: about a fifth of the lattice along each axis, which gives
/// enough tiles to share among ranks but few to write. Longer along an axis where the others are
/// short, if there are many scenes, and without maps; shorter where designs are slow, so that a
/// tile takes at most about a second of one core, up to some million tiles. `extent` is that of the
/// box of each of the `scenes`, and `design_seconds` the time to integrate a design.
Index3 tile_edge(const Index3& extent, std::uint64_t scenes, Maps maps, double design_seconds);

/// Assigns tiles to ranks by the longest-processing-time-first rule: in order of decreasing size,
/// each to the rank with the fewest designs so far. The slowest rank then takes at most 4/3 of the
/// shortest possible time (R. L. Graham, SIAM J. Appl. Math. 17, 1969) if all designs take equally
/// long. The result is the same on every rank.
std::vector<std::vector<NumberedTile>> assign_tiles(const TileRange& range, std::uint64_t ranks,
                                                    const Study& study, const Tiling& tiling);

/// The number of items to process next in about `target` seconds, if the last `count` took
/// `seconds`. At least 1. Grows at most eightfold and shrinks at most tenfold, since short times
/// are unreliable.
std::uint64_t next_count(std::uint64_t count, double seconds, double target);

/// The number of tiles per rank in the first round, if a tile takes about `tile_seconds`, or 0 if
/// that is unknown: a round of a quarter of a second, so that a short sweep needs only one.
std::uint64_t first_tiles_per_rank(double tile_seconds, std::size_t bytes_per_tile);

/// The number of tiles per rank in the next round, if the last round had `tiles_per_rank` and took
/// `round_seconds`: rounds of about two seconds, which make the cost of writing and checkpointing
/// small and lose little work when a run is killed; at most 64 MiB of maps in memory.
std::uint64_t next_tiles_per_rank(std::uint64_t tiles_per_rank, double round_seconds,
                                  std::size_t bytes_per_tile);

}  // namespace trebsweep
