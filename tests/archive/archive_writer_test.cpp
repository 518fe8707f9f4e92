#include "trebsweep/archive/archive_writer.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include "support/archive_reader.hpp"
#include "support/catch.hpp"
#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/mpi.hpp"

using namespace trebsweep;

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool never(double) { return false; }

Lattice small_lattice() {
  LatticeSpec spec;
  spec.increment = 0.1;
  return Lattice(Scene{}, spec);
}

std::vector<MapInfo> two_maps(MapType type) {
  return {{"number", "m s-1", "a number", "flag", type, nan, {}},
          {"flag", "", "a flag", "", MapType::uint8, 0, {"none", "one", "two"}}};
}

double value_of(const Index3& i) {
  return static_cast<double>(i[0] * 10000 + i[1] * 100 + i[2]) + 0.25;
}

ArchiveWriter make_archive(const std::filesystem::path& path, const Lattice& lattice,
                           const Tiling& tiling, const std::vector<MapInfo>& maps,
                           int compression) {
  const Attributes attributes{{"best_speed", nan},
                              {"source", std::string("trebsweep 0")},
                              {"job", std::string("some text")}};
  create_partial(path, {lattice, tiling, maps, compression, attributes}, never, MPI_COMM_WORLD);
  return ArchiveWriter(path, maps, MPI_COMM_WORLD);
}

/// Gives the file its name, too.
void close(ArchiveWriter& archive, const std::filesystem::path& path) {
  archive.close();
  mpi::on_root(MPI_COMM_WORLD, [&] { std::filesystem::rename(partial_path(path), path); });
}

/// Writes every tile, each rank its own, with values that tell their place.
void write_all(ArchiveWriter& archive, const Lattice& lattice, const Tiling& tiling) {
  const auto rank = static_cast<std::uint64_t>(mpi::rank(MPI_COMM_WORLD));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(MPI_COMM_WORLD));
  for (std::uint64_t first = 0; first < tiling.size(); first += ranks) {
    std::optional<Tile> tile;
    std::vector<std::vector<double>> maps(2);
    if (first + rank < tiling.size()) {
      tile = tiling.tile(first + rank);
      for (std::size_t a = 0; a < tile->count[0]; ++a)
        for (std::size_t b = 0; b < tile->count[1]; ++b)
          for (std::size_t c = 0; c < tile->count[2]; ++c) {
            const Index3 i{tile->first[0] + a, tile->first[1] + b, tile->first[2] + c};
            maps[0].push_back(lattice.holds(i) ? value_of(i) : nan);
            maps[1].push_back(lattice.holds(i) ? 2 : 0);
          }
    }
    archive.write(tile, maps);
    archive.mark_done(first, std::vector<TallyRow>(std::min(ranks, tiling.size() - first)));
  }
}

}  // namespace

TEST_CASE("Every value lands at its place, plain and compressed, in each number type") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  for (const int compression : {0, 4})
    for (const MapType type : {MapType::float64, MapType::float32}) {
      const TemporaryFile file("archive");
      ArchiveWriter archive =
          make_archive(file.path(), lattice, tiling, two_maps(type), compression);
      write_all(archive, lattice, tiling);
      archive.write({{"best_speed", 17.5}});
      CHECK_FALSE(std::filesystem::exists(file.path()));
      close(archive, file.path());
      CHECK_FALSE(std::filesystem::exists(partial_path(file.path())));

      if (mpi::rank(MPI_COMM_WORLD) == 0) {
        const auto archived = read_archive_header(file.path());
        REQUIRE(archived);
        CHECK(archived->job == "some text");
        CHECK(archived->is_sweep);
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
        CHECK(done == std::vector<double>(tiling.size(), 1));
        CHECK(read_map(file.path(), "r3") == lattice.axes()[1]);
      }
    }
}

TEST_CASE("What was not written is empty, and not marked done") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  for (const int compression : {0, 1})
    for (const MapType type : {MapType::float64, MapType::float32}) {
      const TemporaryFile file("archive_empty");
      ArchiveWriter archive =
          make_archive(file.path(), lattice, tiling, two_maps(type), compression);
      close(archive, file.path());
      if (mpi::rank(MPI_COMM_WORLD) == 0) {
        for (const double x : read_map(file.path(), "number")) REQUIRE(std::isnan(x));
        for (const double x : read_map(file.path(), "flag")) REQUIRE(x == 0);
        CHECK(read_map(file.path(), "tile_done") == std::vector<double>(tiling.size(), 0));
      }
    }
}

TEST_CASE("The size of an archive is known before it is created") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  const auto maps = two_maps(MapType::float64);
  const Skeleton plain{lattice, tiling, maps, 0, {}}, compressed{lattice, tiling, maps, 1, {}};
  for (const Skeleton& skeleton : {plain, compressed}) {
    const TemporaryFile file("archive_size");
    create_partial(file.path(), skeleton, never, MPI_COMM_WORLD);
    const auto size = static_cast<double>(std::filesystem::file_size(partial_path(file.path())));
    constexpr double descriptions = 20000;  // of maps and axes, whatever the size of the lattice
    const auto least = static_cast<double>(size_of(skeleton));
    CHECK(least <= size);
    CHECK(1.02 * least + descriptions >= size);
  }
}

TEST_CASE("Chunks wholly outside the lattice are never allocated") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  for (const int compression : {0, 1}) {
    const TemporaryFile file("archive_chunks");
    ArchiveWriter archive =
        make_archive(file.path(), lattice, tiling, two_maps(MapType::float64), compression);
    write_all(archive, lattice, tiling);
    close(archive, file.path());
    if (mpi::rank(MPI_COMM_WORLD) == 0) {
      const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
      const hdf5::Dataset map(H5Dopen2(opened, "number", H5P_DEFAULT), "open");
      hsize_t chunks = 0;
      const hdf5::Dataspace space(H5Dget_space(map), "count chunks");
      hdf5::check(H5Dget_num_chunks(map, space, &chunks), "count chunks");
      CHECK(chunks == tiling.size());
      const Index3 n = lattice.extent();
      CHECK(chunks < ((n[0] + 3) / 4) * ((n[1] + 2) / 3) * ((n[2] + 4) / 5));
    }
  }
}

TEST_CASE("An archive that cannot be created is an error that says why") {
  const Lattice lattice = small_lattice();
  CHECK_THROWS_WITH(
      create_partial("/nowhere/a.h5", {lattice, Tiling(lattice, {4, 4, 4}), {}, 0, {}}, never,
                     MPI_COMM_WORLD),
      contains("cannot create /nowhere/a.h5.partial") && contains("No such file"));
}

TEST_CASE("What a machine that went down left in chunks that are not done does no harm") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  const TemporaryFile file("archive_garbage");
  const auto maps = two_maps(MapType::float64);
  { const ArchiveWriter archive = make_archive(file.path(), lattice, tiling, maps, 4); }
  if (mpi::rank(MPI_COMM_WORLD) == 0) {
    std::fstream raw(partial_path(file.path()), std::ios::in | std::ios::out | std::ios::binary);
    {
      const hdf5::File opened(
          H5Fopen(partial_path(file.path()).c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
      for (const MapInfo& info : maps) {
        const hdf5::Dataset map(H5Dopen2(opened, info.dataset.c_str(), H5P_DEFAULT), "open");
        const hdf5::Dataspace space(H5Dget_space(map), "find chunks");
        for (hsize_t chunk = 0; chunk < tiling.size(); ++chunk) {
          haddr_t address = 0;
          hsize_t size = 0;
          unsigned mask = 0;
          std::array<hsize_t, 3> first;
          hdf5::check(H5Dget_chunk_info(map, space, chunk, first.data(), &mask, &address, &size),
                      "find");
          raw.seekp(static_cast<std::streamoff>(address));
          raw << std::string(size, 'x');
        }
      }
    }
    raw.close();
    continue_partial(file.path(), tiling, maps, 0, "went on");
  }
  MPI_Barrier(MPI_COMM_WORLD);
  ArchiveWriter archive(file.path(), maps, MPI_COMM_WORLD);
  write_all(archive, lattice, tiling);
  close(archive, file.path());
  if (mpi::rank(MPI_COMM_WORLD) == 0) {
    const auto numbers = read_map(file.path(), "number");
    CHECK(numbers.front() == value_of({0, 0, 0}));
    const Index3 n = lattice.extent();
    CHECK(numbers[(n[0] - 1) * n[1] * n[2]] == value_of({n[0] - 1, 0, 0}));
  }
}

TEST_CASE("Where any rank is stopped, a partial file that is being made leaves nothing") {
  const Lattice lattice = small_lattice();
  const int last = mpi::size(MPI_COMM_WORLD) - 1;
  for (const double share : {0.0, 0.05, 0.1}) {
    const TemporaryFile file("archive_stopped");
    const auto stop = [&](double done) {
      return mpi::rank(MPI_COMM_WORLD) == (share < 0.1 ? 0 : last) && done >= share;
    };
    CHECK_FALSE(create_partial(
        file.path(), {lattice, Tiling(lattice, {4, 3, 5}), two_maps(MapType::float64), 0, {}}, stop,
        MPI_COMM_WORLD));
    MPI_Barrier(MPI_COMM_WORLD);
    for (const auto& entry : std::filesystem::directory_iterator(file.path().parent_path()))
      CHECK(entry.path().string().find("archive_stopped") == std::string::npos);
  }
}

TEST_CASE("A history grows by a line for each run") {
  const TemporaryFile file("archive_history");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  create_partial(file.path(), {lattice, tiling, {}, 0, {{"history", std::string("began")}}}, never,
                 MPI_COMM_SELF);
  continue_partial(file.path(), tiling, {}, 0, "went on");
  const RunId mark = continue_partial(file.path(), tiling, {}, 0, std::string(5000, 'x'));
  finish(file.path(), mark, "");
  const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  CHECK(hdf5::read_text_attribute(opened, "history") ==
        "began\nwent on\n" + std::string(5000, 'x'));
}

TEST_CASE("A run finishes no file that another one has taken over") {
  const Lattice lattice = small_lattice();
  const Tiling tiling(lattice, {4, 3, 5});
  enum class Event { continued, copied, moved };
  for (const Event event : {Event::continued, Event::copied, Event::moved}) {
    const TemporaryFile file("archive_mark");
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    const auto partial = partial_path(file.path());
    const std::filesystem::path other = partial.string() + ".other";
    const auto mark =
        create_partial(file.path(), {lattice, tiling, {}, 0, {}}, never, MPI_COMM_SELF);
    REQUIRE(mark);
    check_run_id(*mark, partial);
    if (event == Event::continued) continue_partial(file.path(), tiling, {}, 0, "second run");
    if (event == Event::copied) std::filesystem::copy(partial, other);
    if (event == Event::copied) std::filesystem::rename(other, partial);
    if (event == Event::moved) std::filesystem::rename(partial, other);
    CHECK_THROWS_WITH(check_run_id(*mark, partial), contains("another run"));
    CHECK_THROWS_WITH(finish(file.path(), *mark, ""), contains("another run"));
    CHECK_FALSE(std::filesystem::exists(file.path()));
    std::filesystem::remove(other);
  }
}

TEST_CASE("Under the final name only the file that is to be replaced is replaced") {
  const TemporaryFile file("archive_surprise");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const Lattice lattice = small_lattice();
  const auto mark = create_partial(file.path(), {lattice, Tiling(lattice, {4, 3, 5}), {}, 0, {}},
                                   never, MPI_COMM_SELF);
  REQUIRE(mark);
  std::ofstream(file.path()) << "precious";
  CHECK_THROWS_WITH(finish(file.path(), *mark, ""), contains("cannot rename"));
  CHECK(std::filesystem::file_size(file.path()) == 8);
  const std::string found = file_identity(file.path());
  std::ofstream(file.path(), std::ios::app) << "!";
  CHECK_THROWS_WITH(finish(file.path(), *mark, found), contains("cannot rename"));
  finish(file.path(), *mark, file_identity(file.path()));
  CHECK(std::filesystem::file_size(file.path()) > 9);
}
