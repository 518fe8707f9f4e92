#include "trebsweep/sweep/damaged_tiles.hpp"

#include "support/catch.hpp"
#include "support/small_archive.hpp"

using namespace trebsweep;

namespace {

/// Overwrites the tally of a tile.
void damage_tally(const std::filesystem::path& path, hsize_t tile) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
  const hdf5::Dataset tallies = hdf5::open_dataset(file, "tile_tally");
  const hdf5::Dataspace space(H5Dget_space(tallies), "select");
  const std::array<hsize_t, 2> cell{tile, 0};
  hdf5::check(H5Sselect_elements(space, H5S_SELECT_SET, 1, cell.data()), "select");
  const hdf5::Dataspace memory(H5Screate(H5S_SCALAR), "write");
  const double value = 7;
  hdf5::check(H5Dwrite(tallies, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &value), "write");
}

}  // namespace

TEST_CASE("Every rank knows the ranges of damaged tiles") {
  const SmallStudy small;
  const TemporaryFile file("damaged");
  const auto maps = two_maps(MapType::float64);
  ArchiveWriter archive = create_archive(file.path(), small, maps, 0);
  write_all(archive, small);
  close(archive, file.path());
  if (mpi::rank(MPI_COMM_WORLD) == 0)
    for (const hsize_t tile : {1, 2, 5}) damage_tally(file.path(), tile);
  MPI_Barrier(MPI_COMM_WORLD);
  Progress progress(0, small.tiling.size(), ProgressStyle::none);
  const auto find = [&](std::uint64_t done, bool stop) {
    return to_text(damaged_tiles(
        file.path(), maps, small.study, small.tiling, done, progress, [&] { return stop; },
        MPI_COMM_WORLD));
  };
  CHECK(find(small.tiling.size(), false) == "1 to 2, 5");
  CHECK(find(2, false) == "1");
  CHECK(find(small.tiling.size(), true).empty());
}

TEST_CASE("A long list of tiles is shortened") {
  std::vector<TileRange> tiles;
  for (std::uint64_t t = 0; t < 21; ++t) tiles.push_back({2 * t, 2 * t + 1});
  CHECK_THAT(to_text(tiles), contains("0, 2, 4") && contains("36, 38, ..."));
}
