#include "trebsweep/archive/partial.hpp"

#include <array>
#include <fstream>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/archive/verify.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

/// Overwrites the bytes of every chunk of the maps.
void fill_with_garbage(const std::filesystem::path& path, const std::vector<MapInfo>& maps,
                       std::uint64_t chunks) {
  std::fstream raw(path, std::ios::in | std::ios::out | std::ios::binary);
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  for (const MapInfo& info : maps) {
    const hdf5::Dataset map = hdf5::open_dataset(file, info.dataset);
    const hdf5::Dataspace space(H5Dget_space(map), "find chunks");
    for (hsize_t chunk = 0; chunk < chunks; ++chunk) {
      haddr_t address = 0;
      hsize_t size = 0;
      unsigned mask = 0;
      std::array<hsize_t, H5S_MAX_RANK> first;
      hdf5::check(H5Dget_chunk_info(map, space, chunk, first.data(), &mask, &address, &size),
                  "find a chunk");
      raw.seekp(static_cast<std::streamoff>(address));
      raw << std::string(size, 'x');
    }
  }
}

/// A file's superblock, which must have version 2. It stores how much of the file is allocated.
std::string read_superblock(const std::filesystem::path& path) {
  std::string bytes(48, ' ');
  std::ifstream(path, std::ios::binary).read(bytes.data(), 48);
  CHECK(bytes[8] == 2);
  return bytes;
}

void write_superblock(const std::filesystem::path& path, const std::string& bytes) {
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary) << bytes;
}

/// Creates a partial file without maps, on one rank.
RunId create_without_maps(const std::filesystem::path& path, const SmallStudy& small,
                          const std::string& history = "") {
  const auto run_id = create_partial(
      path, {small.study, small.tiling, {}, 0, {{"history", history}}}, never_stop, MPI_COMM_SELF);
  REQUIRE(run_id);
  return *run_id;
}

}  // namespace

TEST_CASE("The size of an archive is known before it is created") {
  const std::vector<MapInfo> none;
  const auto two = two_maps(MapType::float64);
  for (const SmallStudy& small : small_studies())
    for (const auto* maps : {&two, &none})
      for (const int compression : {0, 1}) {
        const Skeleton skeleton{small.study, small.tiling, *maps, compression, {}};
        const TemporaryFile file("archive_size");
        create_partial(file.path(), skeleton, never_stop, MPI_COMM_WORLD);
        const auto size =
            static_cast<double>(std::filesystem::file_size(partial_path(file.path())));
        const auto minimum = static_cast<double>(minimum_size(skeleton));
        const double metadata = 40000;  // bytes, whatever the size of the lattice
        CHECK(minimum <= size);
        CHECK(1.02 * minimum + metadata >= size);
      }
}

TEST_CASE("An archive larger than the free space of the disk is refused before it is created") {
  Job job;
  job.output.file = "a.h5";
  job.lattice.increment = 1.3e-4;  // 3e11 designs
  const Study study(job);
  const Tiling tiling(study, {64, 64, 64});
  const auto maps = two_maps(MapType::float64);
  const TemporaryFile file("archive_too_large");
  const auto create = [&] {
    create_partial(file.path(), {study, tiling, maps, 0, {}}, never_stop, MPI_COMM_WORLD);
  };
  CHECK_THROWS_AS(create(), InputError);
  CHECK_THROWS_WITH(create(), contains("output.file = a.h5: needs at least ") &&
                                  contains(" GB (") && contains("are available in") &&
                                  contains("output.maps = none"));
  CHECK_FALSE(std::filesystem::exists(partial_path(file.path())));
  CHECK_FALSE(std::filesystem::exists(new_path(file.path())));
}

TEST_CASE("An archive that cannot be created is an error that names the cause") {
  const SmallStudy small;
  CHECK_THROWS_WITH(create_partial("/nowhere/a.h5", {small.study, small.tiling, {}, 0, {}},
                                   never_stop, MPI_COMM_WORLD),
                    contains("cannot create /nowhere/a.h5.partial") && contains("No such file"));
}

TEST_CASE("A stop on any rank ends the creation of a partial file and leaves no file behind") {
  const SmallStudy small;
  const int last = mpi::size(MPI_COMM_WORLD) - 1;
  for (const double limit : {0.0, 0.05, 0.1}) {
    const TemporaryFile file("archive_stopped");
    const auto stop = [&](double fraction) {
      return mpi::rank(MPI_COMM_WORLD) == (limit < 0.1 ? 0 : last) && fraction >= limit;
    };
    CHECK_FALSE(create_partial(file.path(),
                               {small.study, small.tiling, two_maps(MapType::float64), 0, {}}, stop,
                               MPI_COMM_WORLD));
    MPI_Barrier(MPI_COMM_WORLD);
    for (const auto& entry : std::filesystem::directory_iterator(file.path().parent_path()))
      CHECK(entry.path().string().find("archive_stopped") == std::string::npos);
  }
}

TEST_CASE("Arbitrary bytes in chunks that are not done do not affect a resumed sweep") {
  for (const SmallStudy& small : small_studies()) {
    const TemporaryFile file("archive_garbage");
    const auto maps = two_maps(MapType::float64);
    const TileRange all{0, small.tiling.size()};
    { const ArchiveWriter archive = create_archive(file.path(), small, maps, 4); }
    if (mpi::rank(MPI_COMM_WORLD) == 0) {
      fill_with_garbage(partial_path(file.path()), maps, all.end);
      continue_partial(file.path(), small.study, small.tiling, maps, {all}, "second run");
    }
    MPI_Barrier(MPI_COMM_WORLD);
    ArchiveWriter archive(file.path(), maps, small.study, MPI_COMM_WORLD);
    write_all(archive, small);
    close(archive, file.path());
    if (mpi::rank(MPI_COMM_WORLD) == 0) {
      const auto numbers = read_map(file.path(), "number");
      const Index3 first{2, 0, 0}, last{small.study.extent()[0] - 1, 0, 0};  // in an edge chunk
      CHECK(numbers[small.study.cell(0, first)] == value_of(0, first));
      const std::uint64_t scene = small.study.scenes() - 1;
      CHECK(numbers[small.study.cell(scene, last)] == value_of(scene, last));
      CHECK(find_damage(file.path(), maps, small.study, small.tiling, all).empty());
    }
  }
}

TEST_CASE("A kill between the index of compressed chunks and the superblock loses no tile") {
  for (const SmallStudy& small : small_studies()) {
    const std::uint64_t tiles = small.tiling.size(), done = tiles / 2;
    const auto maps = two_maps(MapType::float64);
    const auto is_intact = [&](const std::filesystem::path& path, const TileRange& range) {
      return find_damage(path, maps, small.study, small.tiling, range).empty();
    };
    const TemporaryFile uninterrupted("archive_uninterrupted"), file("archive_old_superblock");
    {
      ArchiveWriter archive = create_archive(uninterrupted.path(), small, maps, 4);
      write_all(archive, small);
      close(archive, uninterrupted.path());
    }
    const auto partial = partial_path(file.path());
    std::string superblock;
    {
      ArchiveWriter archive = create_archive(file.path(), small, maps, 4);
      write_tiles(archive, small, {0, done});
      superblock = read_superblock(partial);  // as the checkpoint has left it
      MPI_Barrier(MPI_COMM_WORLD);
      write_tiles(archive, small, {done, tiles});
      archive.close();
    }
    mpi::on_root(MPI_COMM_WORLD, [&] {
      CHECK(superblock != read_superblock(partial));
      write_superblock(partial, superblock);
      CHECK(is_intact(partial, {0, done}));
      CHECK_FALSE(is_intact(partial, {done, tiles}));
      continue_partial(file.path(), small.study, small.tiling, maps, {{done, tiles}}, "second run");
      CHECK(is_intact(partial, {0, done}));
    });
    ArchiveWriter archive(file.path(), maps, small.study, MPI_COMM_WORLD);
    write_tiles(archive, small, {done, tiles});
    close(archive, file.path());
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    CHECK(is_intact(file.path(), {0, tiles}));
    for (const char* dataset : {"tile_checksum", "tile_done"})
      CHECK(read_map(file.path(), dataset) == read_map(uninterrupted.path(), dataset));
  }
}

TEST_CASE("Each run adds a line to the history") {
  const TemporaryFile file("archive_history");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const SmallStudy small;
  create_without_maps(file.path(), small, "first run");
  continue_partial(file.path(), small.study, small.tiling, {}, {}, "second run");
  const std::string long_line(5000, 'x');
  const RunId run_id = continue_partial(file.path(), small.study, small.tiling, {}, {}, long_line);
  finish_partial(file.path(), run_id, "");
  const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  CHECK(hdf5::read_text_attribute(opened, "history") == "first run\nsecond run\n" + long_line);
}

TEST_CASE("A run does not finish a file that another run has taken over") {
  const SmallStudy small;
  enum class Event { continued, copied, moved };
  for (const Event event : {Event::continued, Event::copied, Event::moved}) {
    const TemporaryFile file("archive_run_id");
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    const auto partial = partial_path(file.path());
    const std::filesystem::path other = partial.string() + ".other";
    const RunId run_id = create_without_maps(file.path(), small);
    check_run_id(run_id, partial);
    if (event == Event::continued)
      continue_partial(file.path(), small.study, small.tiling, {}, {}, "second run");
    if (event == Event::copied) std::filesystem::copy(partial, other);
    if (event == Event::copied) std::filesystem::rename(other, partial);
    if (event == Event::moved) std::filesystem::rename(partial, other);
    CHECK_THROWS_WITH(check_run_id(run_id, partial), contains("another run"));
    CHECK_THROWS_WITH(finish_partial(file.path(), run_id, ""), contains("another run"));
    CHECK_FALSE(std::filesystem::exists(file.path()));
    std::filesystem::remove(other);
  }
}

TEST_CASE("Finishing never replaces a file other than the one that existed at the start") {
  const TemporaryFile file("archive_surprise");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const SmallStudy small;
  const RunId run_id = create_without_maps(file.path(), small);
  std::ofstream(file.path()) << "precious";
  CHECK_THROWS_WITH(finish_partial(file.path(), run_id, ""), contains("cannot rename"));
  CHECK(std::filesystem::file_size(file.path()) == 8);
  const std::string identity = file_identity(file.path());
  std::ofstream(file.path(), std::ios::app) << "!";
  CHECK_THROWS_WITH(finish_partial(file.path(), run_id, identity), contains("cannot rename"));
  finish_partial(file.path(), run_id, file_identity(file.path()));
  CHECK(std::filesystem::file_size(file.path()) > 9);
}
