#include "trebsweep/archive/verify.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "support/temporary_directory.hpp"

using namespace trebsweep;

namespace {

/// A tile and a map.
using Damage = std::vector<std::pair<std::uint64_t, std::string>>;

/// What does not match its checksum.
Damage find_damage(const std::filesystem::path& path, const ArchiveContents& contents,
                   const TileRange& tiles) {
  const auto& maps = contents.maps;
  const std::size_t size = (tiles.end - tiles.first) * maps.size();
  const auto intact = std::make_unique<bool[]>(size);
  verify(path, contents, tiles, {intact.get(), size});
  Damage damage;
  for (std::size_t i = 0; i < size; ++i)
    if (!intact[i]) damage.emplace_back(tiles.first + i / maps.size(), maps[i % maps.size()]);
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
  for (const SmallStudy& small : small_studies_in_all_formats()) {
    write_all(path, small);
    CHECK(find_damage(path).empty());
    const ArchiveContents contents = read_contents(path);
    const std::uint64_t end = contents.tiles.size();
    const std::string intact = read_file(path);
    for (std::uint64_t t = 0; t < end; t += contents.is_study() ? 19 : 3)
      for (const std::string map : {"speed", "status"}) {
        std::string bytes = intact;
        bytes[position_of(path, map, small, t)] ^= 1;
        write_file(path, bytes);
        CHECK(find_damage(path) == Damage{{t, map}});
        CHECK(find_damage(path, contents, {t + 1, end}).empty());
        write_file(path, intact);
      }
  }
}

TEST_CASE("Damaged checksums are found") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  for (const SmallStudy& small : small_studies()) {
    write_all(path, small);
    const auto maps = read_contents(path).maps;
    for (std::size_t map = 0; map < maps.size(); ++map) {
      const std::size_t position = 3 * maps.size() + map;
      const auto checksum = exchange(path, "tile_checksum", position, std::uint64_t{1000});
      CHECK(find_damage(path) == Damage{{3, maps[map]}});
      exchange(path, "tile_checksum", position, checksum);
    }
  }
}

TEST_CASE("A map that HDF5 cannot read is damaged, and the others are verified") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const SmallStudy small;
  write_all(path, small);
  std::string bytes = read_file(path);
  const std::string index("TREE\1", 5);  // of the chunks of a map
  const std::size_t last = bytes.rfind(index);
  REQUIRE(last != bytes.npos);
  bytes[last] = 't';
  write_file(path, bytes);
  const Damage damage = find_damage(path);
  CHECK(damage.size() == small.tiling.size());
  CHECK(std::ranges::all_of(damage, [&](const auto& d) { return d.second == damage[0].second; }));
}

TEST_CASE("In a file that cannot be opened nothing is intact") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy());
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
    contents.maps = {"speed", "status", "range"};
    return tiles_per_verification(contents);
  };
  CHECK(tiles_at_once({100, 10, 10}) == (64 << 20) / (100 * 10 * 10 * 3 * 8));
  CHECK(tiles_at_once({801, 1000, 1000}) == 1);
  CHECK(tiles_at_once({1, 1, 1}) == 4096);
}
