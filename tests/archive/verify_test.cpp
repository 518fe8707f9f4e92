#include "trebsweep/archive/verify.hpp"

#include <fstream>
#include <iterator>
#include <utility>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "trebsweep/archive/map_shape.hpp"

using namespace trebsweep;

namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// The position in the file of a tile's chunk.
std::size_t position_of(const std::filesystem::path& path, const std::string& map,
                        const SmallStudy& small, std::uint64_t tile) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  haddr_t address = 0;
  hsize_t size = 0;
  unsigned mask = 0;
  const auto first = MapShape(small.study).first_cell(small.tiling.tile(tile));
  hdf5::check(H5Dget_chunk_info_by_coord(hdf5::open_dataset(file, map), first.data(), &mask,
                                         &address, &size),
              "find a chunk");
  return address;
}

void replace_all(std::string& bytes, const std::string& from, const std::string& to) {
  for (std::size_t i = 0; (i = bytes.find(from, i)) != bytes.npos;)
    bytes.replace(i, from.size(), to);
}

}  // namespace

TEST_CASE("Verification finds the damaged maps of each tile, and nothing in an intact archive") {
  for (const SmallStudy& small : small_studies())
    for (const int compression : {0, 4})
      for (const MapType type : {MapType::float64, MapType::float32}) {
        const TemporaryFile file("verify");
        const TileRange all{0, small.tiling.size()};
        const auto maps = two_maps(type);
        write_all(file.path(), small, maps, compression);
        if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
        const auto find = [&](const TileRange& tiles) {
          return find_damage(file.path(), maps, small.study, small.tiling, tiles);
        };
        CHECK(find(all).empty());
        const std::string intact = read_file(file.path());
        for (std::uint64_t t = 0; t < all.end; t += small.has_optima() ? 19 : 3)
          for (std::size_t m = 0; m < maps.size(); ++m) {
            std::string bytes = intact;
            bytes[position_of(file.path(), maps[m].dataset, small, t)] ^= 1;
            write_file(file.path(), bytes);
            const auto damage = find(all);
            REQUIRE(damage.size() == 1);
            CHECK(damage[0].tile == t);
            CHECK(damage[0].column == m);
            CHECK(find({t + 1, all.end}).empty());
            write_file(file.path(), intact);
          }
      }
}

TEST_CASE("A damaged optimum of a scene belongs to the scene's last tile, with or without maps") {
  const SmallStudy small(job_of_six_scenes());
  const TileRange all{0, small.tiling.size()};
  for (const auto& maps : {two_maps(MapType::float64), std::vector<MapInfo>{}}) {
    const TemporaryFile file("verify_optima");
    write_all(file.path(), small, maps, 0);
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    CHECK(checksum_columns(maps, true)[maps.size()] == "best");
    const auto find = [&](const TileRange& tiles) {
      return find_damage(file.path(), maps, small.study, small.tiling, tiles);
    };
    CHECK(find(all).empty());
    for (const std::uint64_t scene : {1, 5})
      for (std::size_t d = 0; d < scene_optimum_names.size(); ++d) {
        const std::string name(scene_optimum_names[d]);
        auto values = read_map(file.path(), name);
        const auto write = [&] {
          const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
          hdf5::check(H5Dwrite(hdf5::open_dataset(opened, name), H5T_NATIVE_DOUBLE, H5S_ALL,
                               H5S_ALL, H5P_DEFAULT, values.data()),
                      "write");
        };
        const double intact = std::exchange(values[scene], 1000);
        write();
        const auto damage = find(all);
        REQUIRE(damage.size() == 1);
        CHECK(damage[0].tile == small.tiling.of_scene(scene).end - 1);
        CHECK(damage[0].column == maps.size());
        CHECK(find({0, damage[0].tile}).empty());
        values[scene] = intact;
        write();
      }
  }
}

TEST_CASE("What HDF5 cannot read is damaged") {
  const SmallStudy small;
  const TileRange all{0, small.tiling.size()};
  const TemporaryFile file("verify_unreadable");
  const auto maps = two_maps(MapType::float64);
  write_all(file.path(), small, maps, 0);
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const std::string intact = read_file(file.path());
  std::string without_indices = intact;
  replace_all(without_indices, "TREE", "tree");
  for (const std::string& bytes :
       {std::string(), intact.substr(0, intact.size() / 2), without_indices}) {
    write_file(file.path(), bytes);
    CHECK(find_damage(file.path(), maps, small.study, small.tiling, all).size() == 3 * all.end);
  }
}

TEST_CASE("A verification reads at most 64 MiB of maps, but at least a tile") {
  const auto maps = two_maps(MapType::float64);
  Job job;
  job.lattice.r1 = AxisRange{0.6, 1.4, 0.001};
  const Study study(job);
  CHECK(tiles_per_verification(maps, Tiling(study, {100, 10, 10})) ==
        (64 << 20) / (100 * 10 * 10 * 9 + sizeof(TallyRow)));
  CHECK(tiles_per_verification(maps, Tiling(study, {801, 1000, 1000})) == 1);
  CHECK(tiles_per_verification(maps, Tiling(study, {1, 1, 1})) == 4096);
}
