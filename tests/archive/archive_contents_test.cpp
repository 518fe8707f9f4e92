#include "trebsweep/archive/archive_contents.hpp"

#include "support/catch.hpp"
#include "support/small_archive.hpp"

using namespace trebsweep;

namespace {

/// A study without maps, of which the tiles before `done` are done.
void create_unfinished(const std::filesystem::path& path, const SmallStudy& small,
                       std::uint64_t done) {
  const Attributes attributes{
      {"format_version", format_version},  {"job", to_text(small.study.job())},
      {"scene", std::string("a scene")},   {"source", std::string("trebsweep 0")},
      {"kernel", std::string("a kernel")}, {"history", std::string("a run")},
      {"refined_error", trebsweep::nan},   {"error_designs", 0ULL}};
  std::vector<TileResults> tiles;
  for (std::uint64_t t = 0; t < done; ++t) {
    const auto [scene, block] = small.tiling.tile(t);
    TileResults& tile = tiles.emplace_back(TileResults{t, {}, {}});
    tile.tally.add({static_cast<double>(t), 1, 1, Status::released},
                   small.study.cell(scene, block.first), static_cast<double>(t));
  }
  std::vector<SceneOptimum> optima(small.study.scenes());
  optima[0] = optimum_of(0);
  optima[1] = optimum_of(1);
  const std::vector<MapInfo> maps;
  write_archive(path, {small.study, small.tiling, maps, 0, attributes, optima}, tiles);
}

Job job_without_maps() {
  Job job = job_of_six_scenes();
  job.output.maps = Maps::none;
  return job;
}

/// The job with another second height.
Job changed(Job job) {
  job.outer_axes[1].values[1] = 1.8;
  return job;
}

}  // namespace

TEST_CASE("The contents of a study's archive are its axes, optima and tallies") {
  const SmallStudy small(job_without_maps());
  const std::uint64_t done = small.tiling.of_scene(1).end + 2;
  const TemporaryFile file("contents");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  create_unfinished(file.path(), small, done);
  const ArchiveContents contents = read_contents(file.path());
  CHECK(contents.axes == small.study.axes());
  CHECK(contents.outer_axes == std::vector<std::vector<double>>{{50, 75, 100}, {1.5, 1.7}});
  CHECK(contents.tiles_done == done);
  CHECK(contents.tiling(small.study).size() == small.tiling.size());
  REQUIRE(contents.optima.size() == 6);
  CHECK(contents.optima[1].release_time == optimum_of(1).release_time);
  CHECK_FALSE(contents.optima[3].exists());

  const Tally tally = contents.tally();
  CHECK(tally.designs() == done);
  const Tile last = small.tiling.tile(done - 1);
  CHECK(tally.best.cell == small.study.cell(2, last.block.first));
}

TEST_CASE("An archive whose outer axes are not those of its job has no tiles") {
  const SmallStudy small(job_without_maps());
  const TemporaryFile file("contents_of_another");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  create_unfinished(file.path(), small, 1);
  const ArchiveContents contents = read_contents(file.path());
  CHECK_THROWS_WITH(contents.tiling(Study(changed(small.study.job()))), contains("outer axes"));
  CHECK_THROWS_WITH(contents.tiling(Study(job_of_one_scene())), contains("outer axes"));
}

TEST_CASE("An archive without the optima that its job asks for is damaged") {
  const SmallStudy small(job_without_maps());
  const TemporaryFile file("contents_without_optima");
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  create_unfinished(file.path(), small, 1);
  {
    const hdf5::File opened(H5Fopen(file.path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    hdf5::check(H5Ldelete(opened, "best_error", H5P_DEFAULT), "remove");
  }
  CHECK_THROWS_WITH(read_contents(file.path()), contains("best_error"));
}
