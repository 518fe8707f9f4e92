#pragma once

#include <cstdint>
#include <vector>

#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// A tile with its number.
struct NumberedTile {
  std::uint64_t number;
  Tile tile;
};

/// The extent of the tiles of a lattice: about a fifth of the lattice's, so that there are enough
/// tiles to share and not many more to write; larger where one or two axes are short, smaller where
/// designs take long. `seconds` is the time of one design on one core; a tile takes about a second
/// at most.
Index3 tile_edge(const Index3& extent, double seconds);

/// Assigns the tiles [first, end) to ranks, the largest first, each to the rank with the fewest
/// designs so far (longest processing time first). The same on every rank.
std::vector<std::vector<NumberedTile>> assign_tiles(std::uint64_t first, std::uint64_t end,
                                                    std::uint64_t ranks, const Lattice& lattice,
                                                    const Tiling& tiling);

/// How many to take next for a step of about `wanted` seconds, when the last `count` took
/// `seconds`.
std::uint64_t paced(std::uint64_t count, double seconds, double wanted);

/// How many tiles a rank computes before it writes: rounds of about two seconds, within 64 MiB of
/// maps. The last round had `batch` tiles per rank.
std::uint64_t next_batch(std::uint64_t batch, double round_seconds, std::size_t bytes_per_tile);

}  // namespace trebsweep
