#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "support/archive_reader.hpp"
#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A job with some hundred designs and the maps of values_of().
inline Job job_of_one_scene() {
  return parse_job("[lattice]\nincrement = 0.1\n[output]\nfields = speed, status\n", "a.cfg", {});
}

/// The same with 3 x 2 scenes; the lattices of the two heights differ.
inline Job job_of_six_scenes() {
  return parse_job(
      "[scene]\nprojectile-mass = 50:100:25\nfulcrum-height = 1.5, 1.7\n"
      "[lattice]\nincrement = 0.1\n[output]\nfields = speed, status\n",
      "a.cfg", {});
}

inline Job without_maps(Job job) {
  job.output.maps = Maps::none;
  return job;
}

/// A study, and tiles that do not divide its lattices evenly.
struct SmallStudy {
  explicit SmallStudy(const Job& job = job_of_one_scene()) : study(job), tiling(study, {4, 3, 5}) {}

  Study study;
  Tiling tiling;
};

/// Studies of one scene and of six.
inline std::vector<SmallStudy> small_studies() {
  return {SmallStudy(job_of_one_scene()), SmallStudy(job_of_six_scenes())};
}

/// The same without maps.
inline std::vector<SmallStudy> small_studies_without_maps() {
  return {SmallStudy(without_maps(job_of_one_scene())),
          SmallStudy(without_maps(job_of_six_scenes()))};
}

/// The same in all formats of maps.
inline std::vector<SmallStudy> small_studies_in_all_formats() {
  std::vector<SmallStudy> studies;
  for (Job job : {job_of_one_scene(), job_of_six_scenes()})
    for (const Storage storage : {Storage::float64, Storage::float32})
      for (const int compression : {0, 4}) {
        job.output.storage = storage;
        job.output.compression = compression;
        studies.emplace_back(job);
      }
  return studies;
}

inline double value_of(std::uint64_t scene, const Index3& i) {
  return static_cast<double>(((scene * 20 + i[0]) * 20 + i[1]) * 20 + i[2]) + 0.25;
}

/// The optimum of a scene; none in the third.
inline BestDesign optimum_of(std::uint64_t scene) {
  const auto n = static_cast<double>(scene);
  if (scene == 2) return {};
  return to_best_design({n + 0.1, n + 0.2, n + 0.3, n + 0.4, n + 0.5, n + 0.6, n + 0.7});
}

inline std::vector<BestDesign> optima_of(const SmallStudy& small) {
  std::vector<BestDesign> optima;
  for (std::uint64_t scene = 0; scene < small.study.scenes(); ++scene)
    optima.push_back(optimum_of(scene));
  return optima;
}

/// The values of a tile's maps: a number, which is value_of() its cell, and a flag, which is 2.
inline std::vector<std::vector<double>> values_of(const SmallStudy& small, const Tile& tile) {
  std::vector<std::vector<double>> maps(2);
  const auto& [first, count] = tile.block;
  for (std::size_t a = 0; a < count[0]; ++a)
    for (std::size_t b = 0; b < count[1]; ++b)
      for (std::size_t c = 0; c < count[2]; ++c) {
        const Index3 i{first[0] + a, first[1] + b, first[2] + c};
        const bool holds = small.study.lattice(tile.scene).holds(i);
        maps[0].push_back(holds ? value_of(tile.scene, i) : no_value);
        maps[1].push_back(holds ? 2 : 0);
      }
  if (small.study.job().output.maps == Maps::none) maps.clear();
  return maps;
}

/// The results of some tiles, whose designs are all released.
class StoredTiles {
 public:
  /// Of every `step`-th tile of a range.
  StoredTiles(const SmallStudy& small, const TileRange& range, std::uint64_t step = 1) {
    for (std::uint64_t t = range.first; t < range.end; t += step) {
      const Tile tile = small.tiling.tile(t);
      Tally tally;
      tally.statuses[static_cast<std::size_t>(Status::released)] =
          small.study.lattice(tile.scene).designs_in(tile.block);
      bytes_.push_back(to_bytes(tally, values_of(small, tile), small.study.job().output));
      records_.push_back({t, bytes_.back()});
    }
  }

  const std::vector<Record>& records() const { return records_; }

 private:
  std::vector<std::vector<std::byte>> bytes_;
  std::vector<Record> records_;
};

inline void describe_small(const std::filesystem::path& path, const SmallStudy& small) {
  Summary summary;
  summary.optima = optima_of(small);
  write_attributes(path, small.study.job(), {"a run"}, summary);
}

/// Writes some tiles, without MPI.
inline void write_tiles(const std::filesystem::path& path, const SmallStudy& small,
                        const TileRange& range) {
  const auto optima = optima_of(small);
  write_archive(path, {small.study, small.tiling, optima}, StoredTiles(small, range).records());
  describe_small(path, small);
}

/// Writes every tile, without MPI.
inline void write_all(const std::filesystem::path& path, const SmallStudy& small) {
  write_tiles(path, small, {0, small.tiling.size()});
}

/// Writes every tile, each rank its own; collective.
inline void write_together(const std::filesystem::path& path, const SmallStudy& small) {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  const auto optima = optima_of(small);
  write_archive(path, {small.study, small.tiling, optima},
                StoredTiles(small, {rank, small.tiling.size()}, ranks).records(), MPI_COMM_WORLD);
  mpi::on_root(MPI_COMM_WORLD, [&] { describe_small(path, small); });
}

}  // namespace trebsweep
