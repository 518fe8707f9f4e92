#include "trebsweep/archive/archive_writer.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "trebsweep/archive/archive_header.hpp"

using namespace trebsweep;

TEST_CASE("On any number of ranks every value is stored in its cell, in all formats of a map") {
  const SmallLattice small;
  const Lattice& lattice = small.lattice;
  for (const int compression : {0, 4})
    for (const MapType type : {MapType::float64, MapType::float32}) {
      const TemporaryFile file("archive");
      ArchiveWriter archive = create_archive(file.path(), small, two_maps(type), compression);
      write_all(archive, small);
      archive.write({{"best_speed", 17.5}});
      CHECK_FALSE(std::filesystem::exists(file.path()));
      close(archive, file.path());
      CHECK_FALSE(std::filesystem::exists(partial_path(file.path())));

      if (mpi::rank(MPI_COMM_WORLD) == 0) {
        const auto header = read_archive_header(file.path());
        REQUIRE(header);
        CHECK(header->job == "some text");
        CHECK(header->is_sweep);
        const auto numbers = read_map(file.path(), "number"), flags = read_map(file.path(), "flag");
        const Index3 n = lattice.extent();
        std::size_t cell = 0;
        for (std::size_t a = 0; a < n[0]; ++a)
          for (std::size_t b = 0; b < n[1]; ++b)
            for (std::size_t c = 0; c < n[2]; ++c, ++cell) {
              const bool inside = lattice.holds({a, b, c});
              REQUIRE((inside ? numbers[cell] == value_of({a, b, c}) : std::isnan(numbers[cell])));
              REQUIRE(flags[cell] == (inside ? 2 : 0));
            }
        const auto done = read_map(file.path(), "tile_done");
        CHECK(done == std::vector<double>(small.tiling.size(), 1));
        CHECK(read_map(file.path(), "r3") == lattice.axes()[1]);
      }
    }
}

TEST_CASE("Tiles that were not written hold fill values and are not marked done") {
  const SmallLattice small;
  for (const int compression : {0, 1})
    for (const MapType type : {MapType::float64, MapType::float32}) {
      const TemporaryFile file("archive_empty");
      ArchiveWriter archive = create_archive(file.path(), small, two_maps(type), compression);
      close(archive, file.path());
      if (mpi::rank(MPI_COMM_WORLD) == 0) {
        for (const double x : read_map(file.path(), "number")) REQUIRE(std::isnan(x));
        for (const double x : read_map(file.path(), "flag")) REQUIRE(x == 0);
        CHECK(read_map(file.path(), "tile_done") == std::vector<double>(small.tiling.size(), 0));
      }
    }
}

TEST_CASE("Chunks entirely outside the lattice are never allocated") {
  const SmallLattice small;
  for (const int compression : {0, 1}) {
    const TemporaryFile file("archive_chunks");
    ArchiveWriter archive =
        create_archive(file.path(), small, two_maps(MapType::float64), compression);
    write_all(archive, small);
    close(archive, file.path());
    if (mpi::rank(MPI_COMM_WORLD) == 0) {
      const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
      const hdf5::Dataset map = hdf5::open_dataset(opened, "number");
      hsize_t chunks = 0;
      const hdf5::Dataspace space(H5Dget_space(map), "count chunks");
      hdf5::check(H5Dget_num_chunks(map, space, &chunks), "count chunks");
      CHECK(chunks == small.tiling.size());
      const Index3 n = small.lattice.extent();
      CHECK(chunks < ((n[0] + 3) / 4) * ((n[1] + 2) / 3) * ((n[2] + 4) / 5));
    }
  }
}
