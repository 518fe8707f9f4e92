#include "trebsweep/sweep/damaged_tiles.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "trebsweep/archive/verify.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {

std::vector<TileRange> damaged_tiles(const std::filesystem::path& path,
                                     const std::vector<MapInfo>& maps, const Study& study,
                                     const Tiling& tiling, std::uint64_t done, Progress& progress,
                                     const std::function<bool()>& stop, MPI_Comm comm) {
  const std::uint64_t at_once = tiles_per_verification(maps, tiling);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  std::vector<std::uint64_t> damaged(done, 0);  // 1 for each damaged tile
  mpi::on_all(comm, [&] {
    for (std::uint64_t first = rank * at_once; first < done && !stop(); first += ranks * at_once) {
      const TileRange tiles{first, std::min(first + at_once, done)};
      for (const Damage& damage : find_damage(path, maps, study, tiling, tiles))
        damaged[damage.tile] = 1;
      progress.update(std::min(first + ranks * at_once, done));
    }
  });
  mpi::sum(damaged, comm);
  std::vector<TileRange> ranges;
  for (std::uint64_t t = 0; t < done; ++t) {
    if (damaged[t] == 0) continue;
    if (ranges.empty() || ranges.back().end < t) ranges.push_back({t, t});
    ranges.back().end = t + 1;
  }
  return ranges;
}

std::string to_text(const std::vector<TileRange>& tiles) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(tiles.size(), most); ++i) {
    const auto& [first, end] = tiles[i];
    text += fmt::format("{}{}", i > 0 ? ", " : "", first);
    if (end - first > 1) text += fmt::format(" to {}", end - 1);
  }
  return tiles.size() > most ? text + ", ..." : text;
}

}  // namespace trebsweep
