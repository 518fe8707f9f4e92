#include "trebsweep/archive/archive_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "trebsweep/archive/archive_reader.hpp"

using namespace trebsweep;

namespace {

/// The number of chunks of a map that are allocated in the file.
hsize_t allocated_chunks(const std::filesystem::path& path, const std::string& map) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  const hdf5::Dataset dataset = hdf5::open_dataset(file, map);
  const hdf5::Dataspace space(H5Dget_space(dataset), "count chunks");
  hsize_t chunks = 0;
  hdf5::check(H5Dget_num_chunks(dataset, space, &chunks), "count chunks");
  return chunks;
}

/// Checks every value of the maps of an archive.
void check_maps(const std::filesystem::path& path, const Study& study) {
  const auto numbers = read_map(path, "speed"), flags = read_map(path, "status");
  REQUIRE(numbers.size() == study.cells());
  const Index3 n = study.extent();
  std::size_t cell = 0;
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene)
    for (std::size_t a = 0; a < n[0]; ++a)
      for (std::size_t b = 0; b < n[1]; ++b)
        for (std::size_t c = 0; c < n[2]; ++c, ++cell) {
          const bool holds = study.lattice(scene).holds({a, b, c});
          REQUIRE(
              (holds ? numbers[cell] == value_of(scene, {a, b, c}) : std::isnan(numbers[cell])));
          REQUIRE(flags[cell] == (holds ? 2 : 0));
        }
}

}  // namespace

TEST_CASE("On any number of ranks every value is stored in its cell, in all formats of a map") {
  for (const SmallStudy& small : small_studies_in_all_formats()) {
    const TemporaryFile file("archive");
    write_together(file.path(), small);
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    const ArchiveContents contents = read_contents(file.path());
    CHECK(contents.summary.complete);
    CHECK(contents.summary.tally.designs() == small.study.designs());
    CHECK(read_map(file.path(), "r3") == small.study.axes()[1]);
    check_maps(file.path(), small.study);
  }
}

TEST_CASE("The archives that one process and several ranks write have the same checksums") {
  for (const SmallStudy& small : small_studies()) {
    const TemporaryFile together("archive_together"), alone("archive_alone");
    write_together(together.path(), small);
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    write_all(alone.path(), small);
    for (const char* table : {"tile_block", "tile_designs", "tile_checksum"})
      CHECK(hdf5::read_numbers<std::uint64_t>(open_archive(together.path()), table) ==
            hdf5::read_numbers<std::uint64_t>(open_archive(alone.path()), table));
  }
}

TEST_CASE("The optima of a study's scenes are stored over the outer axes, with or without maps") {
  for (const Job& job : {job_of_six_scenes(), without_maps(job_of_six_scenes())}) {
    const TemporaryFile file("archive_optima");
    write_together(file.path(), SmallStudy(job));
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    CHECK(read_map(file.path(), "projectile_mass") == std::vector<double>{50, 75, 100});
    CHECK(read_map(file.path(), "fulcrum_height") == std::vector{1.5, 1.7});
    const hdf5::File opened = open_archive(file.path());
    for (std::size_t d = 0; d < best_names.size(); ++d) {
      const std::string name(best_names[d]);
      CHECK(hdf5::extents(hdf5::open_dataset(opened, name)) == std::vector<hsize_t>{3, 2});
      const auto values = read_map(file.path(), name);
      for (const std::uint64_t scene : {0u, 1u, 3u, 4u, 5u})
        CHECK(values[scene] == to_numbers(optimum_of(scene))[d]);
      CHECK(std::isnan(values[2]));
    }
    for (const char* name : {"speed", "status", "tile_checksum"})
      CHECK(H5Lexists(opened, name, H5P_DEFAULT) == (job.output.maps == Maps::none ? 0 : 1));
  }
}

TEST_CASE("An archive says which cells hold designs, in every scene") {
  for (const SmallStudy& small : small_studies_without_maps()) {
    const TemporaryFile file("archive_lattices");
    write_together(file.path(), small);
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    const auto lattice_of = read_map(file.path(), "scene_lattice"),
               has_r1 = read_map(file.path(), "lattice_r1"),
               rows = read_map(file.path(), "lattice_rows");
    REQUIRE(lattice_of.size() == small.study.scenes());
    const auto [n1, n3, n2] = small.study.extent();
    for (std::uint64_t scene = 0; scene < small.study.scenes(); ++scene) {
      const auto l = static_cast<std::size_t>(lattice_of[scene]);
      for (std::size_t a = 0; a < n1; ++a)
        for (std::size_t b = 0; b < n3; ++b)
          for (std::size_t c = 0; c < n2; ++c)
            REQUIRE(small.study.lattice(scene).holds({a, b, c}) ==
                    (has_r1[l * n1 + a] == 1 && static_cast<double>(c) < rows[l * n3 + b]));
    }
  }
}

TEST_CASE("Axes, maps and optima of a study are described, an archive of one scene has no optima") {
  Job job = job_of_six_scenes();
  job.optimum.objective = to_expression(Field::range);
  const TemporaryFile study("archive_of_study"), single("archive_of_scene");
  for (const auto& [file, of] : {std::pair{&study, job}, {&single, job_of_one_scene()}})
    write_together(file->path(), SmallStudy(of));
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  const hdf5::File file(H5Fopen(study.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  const auto attribute = [&](const char* dataset, const char* name) {
    return hdf5::read_text_attribute(hdf5::open_dataset(file, dataset), name);
  };
  CHECK(attribute("projectile_mass", "units") == "kg");
  CHECK(attribute("projectile_mass", "long_name") == "mass m3 of the projectile");
  CHECK(attribute("speed", "units") == "m s-1");
  CHECK(attribute("speed", "ancillary_variables") == "status");
  CHECK(attribute("status", "flag_meanings").starts_with("outside_lattice released "));
  CHECK(H5Aexists_by_name(file, "status", "ancillary_variables", H5P_DEFAULT) == 0);
  CHECK(attribute("best_value", "units") == "m");
  CHECK_THAT(attribute("best_value", "long_name"), contains("horizontal distance"));
  CHECK(attribute("best_speed", "units") == "m s-1");
  CHECK(attribute("best_release_time", "units") == "s");
  CHECK(attribute("best_r1", "units") == "m");
  CHECK(attribute("best_error", "units") == "m");
  const hdf5::File other(H5Fopen(single.path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  CHECK(H5Lexists(other, "best_value", H5P_DEFAULT) == 0);
}

TEST_CASE("Tiles that were not written hold fill values and no designs", "[alone]") {
  for (const SmallStudy& small : small_studies_in_all_formats()) {
    const TemporaryFile file("archive_some_tiles");
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    write_tiles(file.path(), small, {1, 2});
    const hdf5::File opened = open_archive(file.path());
    for (const char* table : {"tile_designs", "tile_checksum"}) {
      const auto values = hdf5::read_numbers<std::uint64_t>(opened, table);
      const std::size_t columns = values.size() / small.tiling.size();
      for (std::size_t i = 0; i < values.size(); ++i)
        if (i / columns != 1) REQUIRE(values[i] == 0);
      CHECK(values[2 * columns - 1] + values[columns + 1] > 0);
    }
    auto numbers = read_map(file.path(), "speed"), flags = read_map(file.path(), "status");
    auto values = values_of(small, small.tiling.tile(1));
    for (auto* of : {&numbers, &values[0]})
      std::erase_if(*of, [](double x) { return std::isnan(x); });
    CHECK(numbers == values[0]);
    CHECK(std::ranges::count(flags, 2) == std::ssize(numbers));
  }
}

TEST_CASE("Chunks entirely outside the lattice are never allocated") {
  for (const SmallStudy& small : small_studies_in_all_formats()) {
    const TemporaryFile file("archive_chunks");
    write_together(file.path(), small);
    if (mpi::rank(MPI_COMM_WORLD) != 0) continue;
    const hsize_t chunks = allocated_chunks(file.path(), "speed");
    CHECK(chunks == small.tiling.size());
    const Index3 n = small.study.extent();
    CHECK(chunks < small.study.scenes() * ((n[0] + 3) / 4) * ((n[1] + 2) / 3) * ((n[2] + 4) / 5));
  }
}

TEST_CASE("The results of a tile are the same after they were stored as bytes", "[alone]") {
  const SmallStudy small;
  const Output& output = small.study.job().output;
  const Tile tile = small.tiling.tile(2);
  Tally tally;
  tally.add({3, 2, 1, Status::released}, 7, {0.5, 0.6, 0.7}, 5);
  const auto values = values_of(small, tile);
  const auto bytes = to_bytes(tally, values, output);
  CHECK(bytes.size() == result_bytes(tile.block, output));
  const Tally stored = tally_of({2, bytes});
  CHECK(std::ranges::equal(std::as_bytes(std::span(&stored, 1)),
                           std::as_bytes(std::span(&tally, 1))));
  const auto numbers = std::as_bytes(std::span(values[0]));
  CHECK(std::ranges::equal(std::span(bytes).subspan(sizeof tally, numbers.size()), numbers));
  CHECK(bytes.back() == std::byte{static_cast<unsigned char>(values[1].back())});
}

TEST_CASE("Values are rounded to float32, and those beyond its range are infinite", "[alone]") {
  Output output;
  output.fields = {Field::speed};
  output.storage = Storage::float32;
  const std::vector<double> values{0.1, 1e300, -1e300, 1e-300, no_value, 1 + 1e-12};
  const auto bytes = to_bytes({}, {values}, output);
  std::vector<float> stored(values.size());
  REQUIRE(bytes.size() == sizeof(Tally) + stored.size() * sizeof(float));
  std::memcpy(stored.data(), &bytes[sizeof(Tally)], stored.size() * sizeof(float));
  const float infinite = std::numeric_limits<float>::infinity();
  CHECK(stored[0] == 0.1f);
  CHECK(stored[1] == infinite);
  CHECK(stored[2] == -infinite);
  CHECK(stored[3] == 0);
  CHECK(std::isnan(stored[4]));
  CHECK(stored[5] == 1);
}

TEST_CASE("The sizes of journals and archive are known before they are written", "[alone]") {
  const SmallStudy small;
  std::uintmax_t records = record_header_bytes + sizeof(BestDesign);  // of the scene
  for (std::uint64_t t = 0; t < small.tiling.size(); ++t)
    records += record_header_bytes + sizeof(Tally) + small.tiling.tile(t).block.cells() * 9;
  const TemporaryFile file("archive_size");
  write_together(file.path(), small);
  const auto size = static_cast<double>(std::filesystem::file_size(file.path()));
  const auto [archive, journals] = needed_space(small.study, small.tiling);
  const double metadata = 70000;  // bytes, whatever the size of the lattice
  CHECK(journals == records);
  CHECK(static_cast<double>(archive) <= size);
  CHECK(static_cast<double>(archive) + metadata >= size);
  Job compressed = small.study.job();
  compressed.output.compression = 1;
  CHECK(needed_space(Study(compressed), small.tiling).archive == 0);
  MPI_Barrier(MPI_COMM_WORLD);
}
