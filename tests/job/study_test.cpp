#include "trebsweep/job/study.hpp"

#include "support/catch.hpp"
#include "support/six_scenes.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/sample.hpp"

using namespace trebsweep;

TEST_CASE("Scenes are the product of the outer axes, the last one fastest") {
  const Job job = job_of_six_scenes();
  REQUIRE(count_scenes(job) == 6);
  CHECK(outer_index(job, 0) == std::vector<std::uint64_t>{0, 0});
  CHECK(outer_index(job, 2) == std::vector<std::uint64_t>{0, 2});
  CHECK(outer_index(job, 4) == std::vector<std::uint64_t>{1, 1});
  CHECK(scene_at(job, 4).projectile_mass == 100);
  CHECK(scene_at(job, 4).fulcrum_height == 1.5);
  CHECK(scene_at(job, 4).counterweight_mass == job.scene.counterweight_mass);
  CHECK(outer_values_text(job, 4) == "projectile-mass = 100 kg, fulcrum-height = 1.5 m");
}

TEST_CASE("A job without outer axes has one scene") {
  const Job job;
  CHECK(count_scenes(job) == 1);
  CHECK(outer_index(job, 0).empty());
  CHECK(outer_values_text(job, 0).empty());
  const Study study(job);
  CHECK(study.scenes() == 1);
  CHECK(study.designs() == 706860);
  CHECK(study.axes() == Lattice(job.scene, job.lattice).axes());
}

TEST_CASE("The job of a scene is the one that is given its values alone") {
  const Job job = job_of_six_scenes();
  const Job own = parse_job(
      "[scene]\nprojectile-mass = 100\nfulcrum-height = 1.9\n[lattice]\nincrement = 0.05\n",
      "study.cfg", {});
  CHECK(to_text(job_at(job, 5)) == to_text(own));
  CHECK(to_text(job_at(job, 4)) != to_text(own));
}

TEST_CASE("By default all scenes with a trough have the same slings and throwing arms") {
  const Job job = parse_job(
      "[scene]\ntrough = yes\nstart-angle = 0.8\nfulcrum-height = 2, 1, 1.5\n", "study.cfg", {});
  const Study study(job);
  REQUIRE(study.lattices().size() == 3);
  for (const std::size_t axis : {1, 2}) {
    const std::vector<double>& values = study.axes()[axis];
    CHECK(values.front() == Approx(0.4 * 1).margin(job.lattice.increment / 2));
    CHECK(values.back() == Approx(2.2 * 2).margin(job.lattice.increment / 2));
    for (std::uint64_t scene = 0; scene < 3; ++scene)
      CHECK(study.own_lattice(scene).axes()[axis] == values);
  }
  CHECK(to_text(parse_job(to_text(job), "study.cfg", {})) == to_text(job));
}

TEST_CASE("In the common box each scene has the designs of its own lattice, in the same order") {
  const Job job = job_of_six_scenes();
  const Study study(job);
  REQUIRE(study.scenes() == 6);
  CHECK(study.lattices().size() == 3);  // of the heights
  std::uint64_t sum = 0;
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene) {
    const Lattice own(scene_at(job, scene), job.lattice);
    CHECK(study.lattice(scene).axes() == study.axes());
    CHECK(study.lattice(scene).designs() == own.designs());
    CHECK(all_designs(study.lattice(scene)) == all_designs(own));  // bit for bit
    sum += own.designs();
  }
  CHECK(study.designs() == sum);
  // The arm h - h0 < r1 < h0 is long where the frame is tall.
  CHECK(study.axes()[0].front() == 0.15);
  CHECK(study.axes()[0].back() == 1.85);
}

TEST_CASE("The box holds r1 of all scenes once, also where their steps do not coincide") {
  Job job;
  job.lattice.increment = 0.05;
  job.outer_axes = {OuterAxis{"scene.release-height", {2, 2.02}, "2, 2.02"}};
  const Study study(job);
  const auto& r1 = study.axes()[0];
  CHECK(r1[0] == 0.55);
  CHECK(r1[1] == 0.57);
  CHECK(r1[2] == 0.6);
  for (std::uint64_t scene = 0; scene < 2; ++scene)
    CHECK(all_designs(study.lattice(scene)) ==
          all_designs(Lattice(scene_at(job, scene), job.lattice)));
}

TEST_CASE("The lattices in a common box share its axes, so that thousands of them fit in memory") {
  const Study study(job_of_six_scenes());
  for (const Lattice& lattice : study.lattices()) CHECK(&lattice.axes() == &study.axes());
}

TEST_CASE("A cell of the flattened boxes gives its scene and design") {
  const Study study(job_of_six_scenes());
  const Index3 n = study.extent();
  std::uint64_t next = 0;
  for (std::uint64_t scene = 0; scene < study.scenes(); ++scene)
    for (std::size_t a = 0; a < n[0]; ++a)
      for (std::size_t b = 0; b < n[1]; ++b)
        for (std::size_t c = 0; c < n[2]; ++c, ++next) {
          const Index3 index{a, b, c};
          REQUIRE(study.cell(scene, index) == next);
          const auto [found, design] = study.design(next);
          REQUIRE(found == scene);
          REQUIRE(design == study.lattice(scene).design(index));
        }
  CHECK(study.cells() == next);
}

TEST_CASE("A scene without a lattice is named") {
  Job job = job_of_six_scenes();
  job.outer_axes[1].values = {0.9, 1.5, 1.9};
  CHECK_THROWS_AS(Study(job), InputError);
  CHECK_THROWS_WITH(Study(job), contains("scene.release-height = 2 leaves no design") &&
                                    contains("(in the scene with projectile-mass = 50 kg, "
                                             "fulcrum-height = 0.9 m)"));
}

TEST_CASE("A study of too many cells is refused") {
  Job job;
  job.lattice.increment = 3e-4;
  job.outer_axes = {OuterAxis{"scene.wind", std::vector<double>(1000000), "0:999999:1"}};
  CHECK_THROWS_WITH(Study(job), contains("lattice.increment: 1000000 scenes") &&
                                    contains("at most 1e+15 are allowed"));
}

TEST_CASE("A command that needs one scene names the key with several values") {
  CHECK_NOTHROW(require_one_scene(Job{}, "choose one"));
  CHECK_THROWS_AS(require_one_scene(job_of_six_scenes(), "choose one"), InputError);
  CHECK_THROWS_WITH(require_one_scene(job_of_six_scenes(), "choose one"),
                    contains("scene.projectile-mass = 50, 100: must be a single number") &&
                        contains("choose one"));
}
