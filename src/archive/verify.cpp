#include "trebsweep/archive/verify.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>
#include <span>

#include "trebsweep/archive/checksum.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
#include "trebsweep/archive/scene_optimum.hpp"
#include "trebsweep/archive/tally.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

namespace trebsweep {
namespace {

using hdf5::check;

/// Memory that this process shares with its children, filled with zeros.
class SharedFlags {
 public:
  explicit SharedFlags(std::size_t size)
      : size_(size),
        flags_(static_cast<bool*>(
            mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {
    if (flags_ == MAP_FAILED) throw std::bad_alloc();
  }
  ~SharedFlags() { munmap(flags_, size_); }
  SharedFlags(const SharedFlags&) = delete;
  SharedFlags& operator=(const SharedFlags&) = delete;

  bool& operator[](std::size_t i) { return flags_[i]; }

 private:
  std::size_t size_;
  bool* flags_;
};

std::size_t bytes_per_value(MapType type) { return H5Tget_size(file_type(type)); }

/// Reads a block of a dataset, in the type it has in the file, last axis fastest.
void read_block(hid_t dataset, hid_t type, std::span<const hsize_t> first,
                std::span<const hsize_t> count, void* values) {
  const std::string what = "read a tile";
  const hdf5::Dataspace file(H5Dget_space(dataset), what);
  check(H5Sselect_hyperslab(file, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
        what);
  const hdf5::Dataspace memory(
      H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), what);
  check(H5Dread(dataset, type, memory, file, H5P_DEFAULT, values), what);
}

/// Reads rows of a dataset that has one row per tile.
template <class Number>
std::vector<Number> read_rows(hid_t file, const char* name, hid_t type, const TileRange& tiles,
                              std::size_t columns) {
  const std::uint64_t rows = tiles.end - tiles.first;
  std::vector<Number> values(rows * columns);
  read_block(hdf5::open_dataset(file, name), type, std::array<hsize_t, 2>{tiles.first, 0},
             std::array<hsize_t, 2>{rows, columns}, values.data());
  return values;
}

/// Opens a map without a cache of chunks: each is read only once.
hdf5::Dataset open_uncached(hid_t file, const std::string& name) {
  const hdf5::Properties access(H5Pcreate(H5P_DATASET_ACCESS), "open " + name);
  check(H5Pset_chunk_cache(access, 0, 0, 0), "open " + name);
  return {H5Dopen2(file, name.c_str(), access), "open " + name};
}

/// What tiles of a study have in the column best.
std::vector<std::uint64_t> best_checksums(hid_t file, const MapShape& shape, const Tiling& tiling,
                                          const TileRange& tiles) {
  const auto optima = read_optima(file, shape.outer());
  std::vector<std::uint64_t> checksums;
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t) {
    const std::uint64_t scene = tiling.tile(t).scene;
    checksums.push_back(t + 1 == tiling.of_scene(scene).end ? checksum(optima[scene]) : 0);
  }
  return checksums;
}

/// Sets the flags of what matches its checksum: for each tile those of checksum_columns().
void verify(const std::filesystem::path& path, const std::vector<MapInfo>& maps, const Study& study,
            const Tiling& tiling, const TileRange& tiles, SharedFlags& intact) {
  const hdf5::File file = untrusted::open(path);
  const MapShape shape(study);
  const std::size_t columns = checksum_columns(maps, is_study(study.job())).size();
  constexpr std::size_t tally_size = tally_columns.size();
  const auto expected =
      read_rows<std::uint64_t>(file, "tile_checksum", H5T_NATIVE_UINT64, tiles, columns);
  const auto tallies = read_rows<double>(file, "tile_tally", H5T_NATIVE_DOUBLE, tiles, tally_size);
  std::vector<std::uint64_t> best;
  if (is_study(study.job())) best = best_checksums(file, shape, tiling, tiles);
  std::vector<hdf5::Dataset> datasets;
  for (const MapInfo& map : maps) datasets.push_back(open_uncached(file, map.dataset));
  std::vector<std::byte> bytes;
  for (std::uint64_t t = tiles.first; t < tiles.end; ++t) {
    const Tile tile = tiling.tile(t);
    const std::size_t row = (t - tiles.first) * columns;
    for (std::size_t m = 0; m < maps.size(); ++m) {
      bytes.resize(tile.block.cells() * bytes_per_value(maps[m].type));
      try {
        read_block(datasets[m], file_type(maps[m].type), shape.first_cell(tile),
                   shape.block(tile.block.count), bytes.data());
      } catch (const std::runtime_error&) {
        continue;  // damaged so that HDF5 notices it
      }
      intact[row + m] = checksum(bytes) == expected[row + m];
    }
    if (is_study(study.job()))
      intact[row + maps.size()] = best[t - tiles.first] == expected[row + maps.size()];
    const auto tally = std::span(tallies).subspan((t - tiles.first) * tally_size, tally_size);
    const std::size_t last = row + columns - 1;
    intact[last] = checksum(std::as_bytes(tally)) == expected[last];
  }
}

}  // namespace

std::uint64_t tiles_per_verification(const std::vector<MapInfo>& maps, const Tiling& tiling) {
  constexpr std::uint64_t bytes_at_once = std::uint64_t{64} << 20, most = 4096;
  const auto& [n1, n3, n2] = tiling.edge();
  std::uint64_t bytes_per_tile = sizeof(TallyRow);
  for (const MapInfo& map : maps) bytes_per_tile += n1 * n3 * n2 * bytes_per_value(map.type);
  return std::clamp<std::uint64_t>(bytes_at_once / bytes_per_tile, 1, most);
}

std::vector<Damage> find_damage(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                                const Study& study, const Tiling& tiling, const TileRange& tiles) {
  const std::size_t columns = checksum_columns(maps, is_study(study.job())).size();
  const std::size_t flags = (tiles.end - tiles.first) * columns;
  SharedFlags intact(flags);
  // What the child has not reached when HDF5 crashes or hangs remains damaged.
  untrusted::completes(path, [&] { verify(path, maps, study, tiling, tiles, intact); });
  std::vector<Damage> damage;
  for (std::size_t i = 0; i < flags; ++i)
    if (!intact[i]) damage.push_back({tiles.first + i / columns, i % columns});
  return damage;
}

}  // namespace trebsweep
