#include "trebsweep/archive/verify.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "support/temporary_directory.hpp"

using namespace trebsweep;

namespace {

/// A tile and a column of tile_checksum.
using Damage = std::vector<std::pair<std::uint64_t, std::string>>;

/// What does not match its checksum.
Damage find_damage(const std::filesystem::path& path, const ArchiveContents& contents,
                   const TileRange& tiles) {
  const auto& columns = contents.checksum_columns;
  const std::size_t size = (tiles.end - tiles.first) * columns.size();
  const auto intact = std::make_unique<bool[]>(size);
  verify(path, contents, tiles, {intact.get(), size});
  Damage damage;
  for (std::size_t i = 0; i < size; ++i)
    if (!intact[i])
      damage.emplace_back(tiles.first + i / columns.size(), columns[i % columns.size()]);
  return damage;
}

Damage find_damage(const std::filesystem::path& path) {
  const ArchiveContents contents = read_contents(path);
  return find_damage(path, contents, {0, contents.tiles.size()});
}

/// The position in the file of a tile's chunk.
std::size_t position_of(const std::filesystem::path& path, const std::string& map,
                        const SmallStudy& small, std::uint64_t tile) {
  const hdf5::File file = open_archive(path);
  haddr_t address = 0;
  hsize_t size = 0;
  unsigned mask = 0;
  const auto first = map_block(small.tiling.tile(tile), map_extents(small.study)).first;
  hdf5::check(H5Dget_chunk_info_by_coord(hdf5::open_dataset(file, map), first.data(), &mask,
                                         &address, &size),
              "find a chunk");
  return address;
}

/// Replaces a number of a dataset and returns what it was.
template <class Number>
Number exchange(const std::filesystem::path& path, const std::string& name, std::size_t position,
                Number number) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
  auto values = hdf5::read_numbers<Number>(file, name);
  const Number before = std::exchange(values.at(position), number);
  hdf5::check(H5Dwrite(hdf5::open_dataset(file, name), hdf5::native_type<Number>(), H5S_ALL,
                       H5S_ALL, H5P_DEFAULT, values.data()),
              "write");
  return before;
}

}  // namespace

TEST_CASE("Verification finds the damaged maps of each tile, and nothing in an intact archive") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  for (const SmallStudy& small : small_studies())
    for (const int compression : {0, 4})
      for (const MapType type : {MapType::float64, MapType::float32}) {
        write_all(path, small, two_maps(type), compression);
        CHECK(find_damage(path).empty());
        const ArchiveContents contents = read_contents(path);
        const std::uint64_t end = contents.tiles.size();
        const std::string intact = read_file(path);
        for (std::uint64_t t = 0; t < end; t += contents.is_study() ? 19 : 3)
          for (const std::string map : {"number", "flag"}) {
            std::string bytes = intact;
            bytes[position_of(path, map, small, t)] ^= 1;
            write_file(path, bytes);
            CHECK(find_damage(path) == Damage{{t, map}});
            CHECK(find_damage(path, contents, {t + 1, end}).empty());
            write_file(path, intact);
          }
      }
}

TEST_CASE("A damaged optimum of a scene belongs to the scene's last tile, with or without maps") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const SmallStudy small(job_of_six_scenes());
  for (const auto& maps : {two_maps(MapType::float64), std::vector<MapInfo>{}}) {
    write_all(path, small, maps, 0);
    CHECK(find_damage(path).empty());
    for (const std::uint64_t scene : {1u, 5u})
      for (const std::string_view name : best_names) {
        const std::uint64_t last = small.tiling.of_scene(scene).end - 1;
        const double intact = exchange(path, std::string(name), scene, 1000.);
        CHECK(find_damage(path) == Damage{{last, "best"}});
        CHECK(find_damage(path, read_contents(path), {0, last}).empty());
        exchange(path, std::string(name), scene, intact);
      }
  }
}

TEST_CASE("Damaged counts of designs and damaged checksums are found") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  for (const SmallStudy& small : small_studies()) {
    write_all(path, small, two_maps(MapType::float64), 0);
    const std::uint64_t intact =
        exchange(path, "tile_designs", 3 * status_names.size() + 1, std::uint64_t{1000});
    CHECK(find_damage(path) == Damage{{3, "tile_designs"}});
    exchange(path, "tile_designs", 3 * status_names.size() + 1, intact);
    const auto columns = read_contents(path).checksum_columns;
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const std::size_t position = 3 * columns.size() + column;
      const auto checksum = exchange(path, "tile_checksum", position, std::uint64_t{1000});
      CHECK(find_damage(path) == Damage{{3, columns[column]}});
      exchange(path, "tile_checksum", position, checksum);
    }
  }
}

TEST_CASE("A map that HDF5 cannot read is damaged, and the others are verified") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const SmallStudy small;
  write_all(path, small, two_maps(MapType::float64), 0);
  std::string bytes = read_file(path);
  const std::string index("TREE\1", 5);  // of the chunks of a map
  const std::size_t first = bytes.find(index);
  REQUIRE(first != bytes.npos);
  bytes[first] = 't';
  write_file(path, bytes);
  const Damage damage = find_damage(path);
  CHECK(damage.size() == small.tiling.size());
  CHECK(std::ranges::all_of(damage, [&](const auto& d) { return d.second == damage[0].second; }));
}

TEST_CASE("In a file that cannot be opened nothing is intact") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy(), two_maps(MapType::float64), 0);
  const ArchiveContents contents = read_contents(path);
  const std::string intact = read_file(path);
  for (const std::string& bytes : {std::string(), intact.substr(0, intact.size() / 2)}) {
    write_file(path, bytes);
    CHECK_THROWS_AS(find_damage(path, contents, {0, contents.tiles.size()}), std::runtime_error);
  }
}

TEST_CASE("A verification reads at most 64 MiB of maps, but at least a tile") {
  const auto tiles_at_once = [](const Index3& largest) {
    ArchiveContents contents;
    contents.tiles = {{0, {{0, 0, 0}, {1, 1, 1}}}, {0, {{0, 0, 0}, largest}}};
    contents.checksum_columns = {"speed", "status", "tile_designs"};
    return tiles_per_verification(contents);
  };
  CHECK(tiles_at_once({100, 10, 10}) == (64 << 20) / (100 * 10 * 10 * 3 * 8));
  CHECK(tiles_at_once({801, 1000, 1000}) == 1);
  CHECK(tiles_at_once({1, 1, 1}) == 4096);
}
