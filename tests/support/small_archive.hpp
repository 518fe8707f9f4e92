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

/// A job with some hundred designs per scene.
inline Job job_of_one_scene() { return parse_job("[lattice]\nincrement = 0.1\n", "a.cfg", {}); }

/// A job of 3 x 2 scenes; the lattices of the two heights differ.
inline Job job_of_six_scenes() {
  return parse_job(
      "[scene]\nprojectile-mass = 50:100:25\nfulcrum-height = 1.5, 1.7\n"
      "[lattice]\nincrement = 0.1\n",
      "a.cfg", {});
}

/// A study, and tiles that do not divide its lattices evenly.
struct SmallStudy {
  explicit SmallStudy(const Job& job = job_of_one_scene()) : study(job), tiling(study, {4, 3, 5}) {}

  bool has_optima() const { return !study.job().outer_axes.empty(); }

  Study study;
  Tiling tiling;
};

/// Studies of one scene and of six.
inline std::vector<SmallStudy> small_studies() {
  return {SmallStudy(job_of_one_scene()), SmallStudy(job_of_six_scenes())};
}

/// A map of numbers, which are value_of() their cell, and a map of flags, which are 2.
inline std::vector<MapInfo> two_maps(MapType type) {
  return {{"number", "m s-1", "a number", "flag", type, nan, {}},
          {"flag", "", "a flag", "", MapType::uint8, 0, {"none", "one", "two"}}};
}

inline double value_of(std::uint64_t scene, const Index3& i) {
  return static_cast<double>(((scene * 20 + i[0]) * 20 + i[1]) * 20 + i[2]) + 0.25;
}

/// The optimum of a scene; none in the third.
inline SceneOptimum optimum_of(std::uint64_t scene) {
  const auto n = static_cast<double>(scene);
  return scene == 2 ? SceneOptimum{}
                    : SceneOptimum{n + 0.1, n + 0.2, n + 0.3, n + 0.4, n + 0.5, n + 0.6, n + 0.7};
}

/// Creates a partial file without results and opens it; collective.
inline ArchiveWriter create_archive(const std::filesystem::path& path, const SmallStudy& small,
                                    const std::vector<MapInfo>& maps, int compression) {
  const Attributes attributes{{"best_speed", nan},
                              {"source", std::string("trebsweep 0")},
                              {"job", std::string("some text")}};
  create_partial(path, {small.study, small.tiling, maps, compression, attributes}, never_stop,
                 MPI_COMM_WORLD);
  return ArchiveWriter(path, maps, small.study, MPI_COMM_WORLD);
}

/// The values of two_maps() in a tile.
inline std::vector<std::vector<double>> values_of(const SmallStudy& small, const Tile& tile) {
  std::vector<std::vector<double>> maps(2);
  const auto& [first, count] = tile.block;
  for (std::size_t a = 0; a < count[0]; ++a)
    for (std::size_t b = 0; b < count[1]; ++b)
      for (std::size_t c = 0; c < count[2]; ++c) {
        const Index3 i{first[0] + a, first[1] + b, first[2] + c};
        const bool holds = small.study.lattice(tile.scene).holds(i);
        maps[0].push_back(holds ? value_of(tile.scene, i) : nan);
        maps[1].push_back(holds ? 2 : 0);
      }
  return maps;
}

/// Writes the optima of the scenes whose last tile is in a range; collective.
inline void write_optima(ArchiveWriter& archive, const SmallStudy& small, const TileRange& range) {
  for (std::uint64_t scene = 0; scene < small.study.scenes(); ++scene) {
    const std::uint64_t last = small.tiling.of_scene(scene).end - 1;
    if (range.first <= last && last < range.end)
      archive.write_optima(scene, std::vector{optimum_of(scene)});
  }
}

/// Writes tiles with the first maps of two_maps(), each rank its own, in rounds; collective.
inline void write_tiles(ArchiveWriter& archive, const SmallStudy& small, const TileRange& range,
                        std::size_t maps = 2) {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  const std::size_t columns = maps + (small.has_optima() ? 1 : 0);
  for (std::uint64_t first = range.first; first < range.end; first += ranks) {
    const TileRange round{first, std::min(first + ranks, range.end)};
    std::vector<std::uint64_t> checksums((round.end - first) * columns);
    if (first + rank < round.end) {
      const Tile tile = small.tiling.tile(first + rank);
      auto values = values_of(small, tile);
      values.resize(maps);
      const auto of_maps = archive.write(tile, values);
      std::copy(of_maps.begin(), of_maps.end(), &checksums[columns * rank]);
      if (small.has_optima() && first + rank + 1 == small.tiling.of_scene(tile.scene).end)
        checksums[columns * rank + maps] = checksum(optimum_of(tile.scene));
    } else {
      archive.write(std::nullopt, {});
    }
    mpi::sum_on_root(checksums, MPI_COMM_WORLD);
    if (small.has_optima()) write_optima(archive, small, round);
    archive.checkpoint(first, std::vector<TallyRow>(round.end - first), checksums);
  }
}

/// Writes every tile; collective.
inline void write_all(ArchiveWriter& archive, const SmallStudy& small, std::size_t maps = 2) {
  write_tiles(archive, small, {0, small.tiling.size()}, maps);
}

/// Closes the archive and gives it its final name; collective.
inline void close(ArchiveWriter& archive, const std::filesystem::path& path) {
  archive.close();
  mpi::on_root(MPI_COMM_WORLD, [&] { std::filesystem::rename(partial_path(path), path); });
}

}  // namespace trebsweep
