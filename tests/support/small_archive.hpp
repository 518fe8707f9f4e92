#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "support/archive_reader.hpp"
#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A ProgressCallback that never stops.
inline bool never_stop(double) { return false; }

/// A lattice of some hundred designs, and tiles that do not divide it evenly.
struct SmallLattice {
  Lattice lattice = [] {
    LatticeSpec spec;
    spec.increment = 0.1;
    return Lattice(Scene{}, spec);
  }();
  Tiling tiling{lattice, {4, 3, 5}};
};

/// A map of numbers, which are value_of() their cell, and a map of flags, which are 2.
inline std::vector<MapInfo> two_maps(MapType type) {
  return {{"number", "m s-1", "a number", "flag", type, nan, {}},
          {"flag", "", "a flag", "", MapType::uint8, 0, {"none", "one", "two"}}};
}

inline double value_of(const Index3& i) {
  return static_cast<double>(i[0] * 10000 + i[1] * 100 + i[2]) + 0.25;
}

/// Creates a partial file without results and opens it; collective.
inline ArchiveWriter create_archive(const std::filesystem::path& path, const SmallLattice& small,
                                    const std::vector<MapInfo>& maps, int compression) {
  const Attributes attributes{{"best_speed", nan},
                              {"source", std::string("trebsweep 0")},
                              {"job", std::string("some text")}};
  create_partial(path, {small.lattice, small.tiling, maps, compression, attributes}, never_stop,
                 MPI_COMM_WORLD);
  return ArchiveWriter(path, maps, MPI_COMM_WORLD);
}

/// Writes tiles, each rank its own, in rounds; collective.
inline void write_tiles(ArchiveWriter& archive, const SmallLattice& small, const TileRange& range) {
  const auto& [lattice, tiling] = small;
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  for (std::uint64_t first = range.first; first < range.end; first += ranks) {
    std::optional<Tile> tile;
    std::vector<std::vector<double>> maps(2);
    if (first + rank < range.end) {
      tile = tiling.tile(first + rank);
      for (std::size_t a = 0; a < tile->count[0]; ++a)
        for (std::size_t b = 0; b < tile->count[1]; ++b)
          for (std::size_t c = 0; c < tile->count[2]; ++c) {
            const Index3 i{tile->first[0] + a, tile->first[1] + b, tile->first[2] + c};
            maps[0].push_back(lattice.holds(i) ? value_of(i) : nan);
            maps[1].push_back(lattice.holds(i) ? 2 : 0);
          }
    }
    const std::uint64_t tiles = std::min(ranks, range.end - first);
    std::vector<std::uint64_t> checksums(tiles * maps.size());
    const auto of_tile = archive.write(tile, maps);
    if (tile) std::copy(of_tile.begin(), of_tile.end(), &checksums[rank * maps.size()]);
    mpi::sum_on_root(checksums, MPI_COMM_WORLD);
    archive.checkpoint(first, std::vector<TallyRow>(tiles), checksums);
  }
}

/// Writes every tile; collective.
inline void write_all(ArchiveWriter& archive, const SmallLattice& small) {
  write_tiles(archive, small, {0, small.tiling.size()});
}

/// Closes the archive and gives it its final name; collective.
inline void close(ArchiveWriter& archive, const std::filesystem::path& path) {
  archive.close();
  mpi::on_root(MPI_COMM_WORLD, [&] { std::filesystem::rename(partial_path(path), path); });
}

}  // namespace trebsweep
