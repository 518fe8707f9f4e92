#include "trebsweep/archive/archive_reader.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "support/temporary_directory.hpp"

using namespace trebsweep;

namespace {

/// Changes an open archive.
void change(const std::filesystem::path& path, const std::function<void(hid_t)>& f) {
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
  f(file);
}

/// Replaces the value of an attribute.
template <class Value>
void replace_attribute(hid_t file, const std::string& name, const Value& value) {
  hdf5::check(H5Adelete(file, name.c_str()), "remove " + name);
  hdf5::write_attribute(file, name, value);
}

void remove_dataset(hid_t file, const std::string& name) {
  hdf5::check(H5Ldelete(file, name.c_str(), H5P_DEFAULT), "remove " + name);
}

/// Replaces a table by another, with the same columns.
void replace_table(hid_t file, const std::string& name, const std::vector<std::uint64_t>& values) {
  const auto columns = hdf5::read_text_attribute(hdf5::open_dataset(file, name), "columns");
  remove_dataset(file, name);
  const hsize_t size = values.size();
  hdf5::write_attribute(hdf5::create_dataset(file, name, {&size, 1}, values), "columns", columns);
}

}  // namespace

TEST_CASE("The tiles, axes and optima of an archive are read as they were written") {
  const TemporaryDirectory directory;
  for (const SmallStudy& small : small_studies()) {
    const auto path = directory / "a.h5";
    const bool of_study = is_study(small.study.job());
    write_all(path, small);
    const ArchiveContents contents = read_contents(path);
    CHECK(contents.header.job == to_text(small.study.job()));
    CHECK(contents.header.history == "a run");
    CHECK(contents.header.is_sweep());
    CHECK(contents.axes == small.study.axes());
    CHECK(contents.extents == map_extents(small.study));
    CHECK(contents.is_study() == of_study);
    CHECK(contents.maps == std::vector<std::string>{"speed", "status"});
    REQUIRE(contents.tiles.size() == small.tiling.size());
    for (std::uint64_t t = 0; t < small.tiling.size(); ++t) {
      const Tile tile = small.tiling.tile(t);
      REQUIRE(contents.tiles[t].scene == tile.scene);
      REQUIRE(contents.tiles[t].block.first == tile.block.first);
      REQUIRE(contents.tiles[t].block.count == tile.block.count);
    }
    REQUIRE(contents.scenes() == small.study.scenes());
    for (std::uint64_t scene = 0; scene < contents.scenes(); ++scene) {
      const BestDesign& optimum = contents.summary.optima[scene];
      CHECK(optimum.exists() == optimum_of(scene).exists());
      if (optimum.exists()) CHECK(to_numbers(optimum) == to_numbers(optimum_of(scene)));
    }
  }
}

TEST_CASE("The designs of an archive are those of its tiles, and it is complete with all of them") {
  const TemporaryDirectory directory;
  const SmallStudy small(without_maps(job_of_six_scenes()));
  const std::uint64_t tiles = small.tiling.of_scene(1).end + 2;
  const auto designs = [&](const TileRange& range) {
    write_tiles(directory / "a.h5", small, range);
    const ArchiveContents contents = read_contents(directory / "a.h5");
    CHECK(contents.tiles_done == range.end - range.first);
    CHECK(contents.summary.complete == (contents.tiles_done == small.tiling.size()));
    CHECK(contents.summary.tally.statuses[static_cast<std::size_t>(Status::released)] ==
          contents.summary.tally.designs());
    return contents.summary.tally.designs();
  };
  const std::uint64_t some = designs({0, tiles}), rest = designs({tiles, small.tiling.size()});
  CHECK(some > small.study.lattice(0).designs() + small.study.lattice(1).designs());
  CHECK(some + rest == small.study.designs());
  CHECK(designs({0, small.tiling.size()}) == small.study.designs());
}

TEST_CASE("An archive whose tiles are not within its maps is damaged") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const SmallStudy small(job_of_six_scenes());
  write_all(path, small);
  const auto intact = hdf5::read_numbers<std::uint64_t>(open_archive(path), "tile_block");
  const auto write = [&](const std::vector<std::uint64_t>& blocks) {
    change(path, [&](hid_t file) { replace_table(file, "tile_block", blocks); });
  };
  const std::uint64_t huge = ~std::uint64_t{0};
  for (std::size_t column = 0; column < block_columns.size(); ++column)
    for (const std::uint64_t wrong : {std::uint64_t{0}, std::uint64_t{100}, huge, huge - 3}) {
      if (wrong == 0 && column < 4) continue;  // a tile may be the first
      auto blocks = intact;
      blocks[block_columns.size() * 7 + column] = wrong;
      write(blocks);
      CHECK_THROWS_WITH(read_contents(path), contains("damaged: tile 7 lies outside the lattice"));
    }
  write({intact.begin(), intact.end() - 1});
  CHECK_THROWS_WITH(read_contents(path), contains("tile_block does not have a row for each tile"));
  write({intact.begin(), intact.end() - 7});  // one tile fewer than in the other tables
  CHECK_THROWS_WITH(read_contents(path), contains("does not have a row for each tile"));
  write(intact);
  CHECK(read_contents(path).tiles.size() == small.tiling.size());
}

TEST_CASE("An archive without the optima of its scenes, or with those of others, is damaged") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  const SmallStudy small(job_of_six_scenes());
  write_all(path, small);
  change(path, [](hid_t file) {
    remove_dataset(file, "best_error");
    const std::vector<hsize_t> swapped{2, 3};
    hdf5::create_dataset(file, "best_error", swapped, std::vector<double>(6));
  });
  CHECK_THROWS_WITH(read_contents(path), contains("the extent of best_error"));
  change(path, [](hid_t file) { remove_dataset(file, "best_error"); });
  CHECK_THROWS_WITH(read_contents(path), contains("best_error"));
}

TEST_CASE("An archive with a map of another extent is damaged") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy());
  change(path, [](hid_t file) {
    remove_dataset(file, "speed");
    const std::vector<hsize_t> extents{1, 2, 3};
    hdf5::create_dataset(file, "speed", extents, std::vector<double>(6));
  });
  CHECK_THROWS_WITH(read_contents(path), contains("the extent of map speed"));
}

TEST_CASE("An archive with more scenes than it stores lattices of is damaged") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy(job_of_six_scenes()));
  change(path, [](hid_t file) {
    remove_dataset(file, "scene_lattice");
    const std::vector<hsize_t> extents{hsize_t{1} << 28, hsize_t{1} << 28};
    hdf5::create_dataset(file, "scene_lattice", H5T_STD_U64LE, extents);
  });
  CHECK_THROWS_AS(read_contents(path), std::runtime_error);
}

TEST_CASE("An archive with impossible counts is damaged") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy());
  for (const std::string name : {"steps", "lane_steps", "error_designs"}) {
    for (const double wrong : {-1.0, 1e17, no_value, 1e300}) {
      change(path, [&](hid_t file) { replace_attribute(file, name, wrong); });
      CHECK_THROWS_WITH(read_contents(path), contains(name));
    }
    change(path, [&](hid_t file) { replace_attribute(file, name, 5.0); });
    CHECK_NOTHROW(read_contents(path));
  }
}

TEST_CASE("The attributes name the objective, and hold its best value in its unit") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  Job job = without_maps(job_of_six_scenes());
  job.optimum.objective = to_expression(Field::impact_speed);
  const SmallStudy small(job);
  write_all(path, small);
  {
    const hdf5::File file = open_archive(path);
    CHECK(hdf5::read_text_attribute(file, "objective") == "impact-speed");
    CHECK(hdf5::read_text_attribute(file, "objective_units") == "m s-1");
    const auto best = to_numbers(optimum_of(5));  // of the best scene
    for (std::size_t d = 0; d < best.size(); ++d)
      CHECK(hdf5::read_number_attribute(file, std::string(best_names[d])) == best[d]);
  }
  const std::vector<BestDesign> none(small.study.scenes());
  write_archive(path, {small.study, small.tiling, none}, {});
  Summary summary;
  summary.optima = none;
  write_attributes(path, job, {"a run", "another"}, summary);
  const hdf5::File file = open_archive(path);
  CHECK(hdf5::read_text_attribute(file, "history") == "a run\nanother");
  for (const std::string_view name : best_names)
    CHECK(std::isnan(hdf5::read_number_attribute(file, std::string(name))));
}

TEST_CASE("Damage to any value of a table, an axis or an optimum is found on reading") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy(job_of_six_scenes()));
  struct Chunk {
    std::string name;
    haddr_t address;
    hsize_t size;
  };
  std::vector<Chunk> tables;
  {
    const hdf5::File file = open_archive(path);
    for (const std::string& name : hdf5::link_names(file)) {
      const hdf5::Dataset dataset = hdf5::open_dataset(file, name);
      if (name == "speed" || name == "status" || H5Dget_storage_size(dataset) == 0) continue;
      const std::vector<hsize_t> first(hdf5::extents(dataset).size());
      unsigned mask = 0;
      haddr_t address = 0;
      hsize_t size = 0;
      hdf5::check(H5Dget_chunk_info_by_coord(dataset, first.data(), &mask, &address, &size), name);
      tables.push_back({name, address, size});
    }
  }
  CHECK(tables.size() == 3 + 2 + best_names.size() + 3 + 3);
  const std::string intact = read_file(path);
  for (const auto& [name, address, size] : tables)
    for (const hsize_t offset : {hsize_t{0}, size / 2}) {
      std::string bytes = intact;
      bytes[address + offset] ^= 4;
      write_file(path, bytes);
      CHECK_THROWS_WITH(read_contents(path), contains("cannot read " + name + ": "));
    }
}

TEST_CASE("Of an archive of another version only the header is read") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy());
  change(path, [](hid_t file) { replace_attribute(file, "format_version", std::uint64_t{99}); });
  CHECK(read_header(path).history == "a run");
  CHECK_THROWS_WITH(read_contents(path), contains("format_version is 99"));
}

TEST_CASE("A file of another program, or with text that a terminal would interpret, is refused") {
  const TemporaryDirectory directory;
  const auto path = directory / "a.h5";
  write_all(path, SmallStudy());
  change(path, [](hid_t file) { replace_attribute(file, "history", "a\x1b[31m run"); });
  CHECK_THROWS_WITH(read_header(path), contains("attribute history is not text"));
  change(path, [](hid_t file) {
    replace_attribute(file, "history", "two\n\truns");
    replace_attribute(file, "source", "treb 1");
  });
  CHECK_THROWS_WITH(read_header(path), contains("another program"));
  write_file(path, "precious");
  CHECK_THROWS(read_header(path));
}
