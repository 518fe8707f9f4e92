#include "trebsweep/archive/scene_table.hpp"

#include <algorithm>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

/// A study of projectile masses 1, 2, ..., and optima whose speed is 100 / mass.
Job study_of(int scenes) {
  Job job;
  job.outer_axes = {{"scene.projectile-mass", {}, ""}};
  for (int mass = 1; mass <= scenes; ++mass) job.outer_axes[0].values.push_back(mass);
  return job;
}

std::vector<SceneOptimum> optima_of(int scenes) {
  std::vector<SceneOptimum> optima;
  for (int mass = scenes; mass >= 1; --mass)
    optima.insert(optima.begin(), {100.0 / mass, 100.0 / mass, 0.5, 0.6, 0.9, 1, 1e-9});
  return optima;
}

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

TEST_CASE("The table of scenes has units, and the largest value first") {
  auto optima = optima_of(3);
  std::swap(optima[0], optima[2]);
  CHECK(scene_table(study_of(3), optima, true) == R"(scenes    3
          projectile-mass      speed   r1   r2   r3  error
                       kg        m/s    m    m    m    m/s
                        3        100  0.5  0.9  0.6  1e-09
                        2         50  0.5  0.9  0.6  1e-09
                        1  33.333333  0.5  0.9  0.6  1e-09)");
}

TEST_CASE("Of more than 20 scenes, the table has the ten best and the worst") {
  CHECK(lines(scene_table(study_of(20), optima_of(20), true)) == 22);
  const std::string text = scene_table(study_of(21), optima_of(21), true);
  CHECK(lines(text) == 13);
  CHECK_THAT(text, contains("scenes    21; the 10 best, and the worst\n"));
  CHECK_THAT(text.substr(text.rfind('\n')), contains(" 21  4.7619048 "));
}

TEST_CASE("Scenes without an optimum are counted and not listed") {
  auto optima = optima_of(3);
  optima[1] = {};
  const std::string text = scene_table(study_of(3), optima, true);
  CHECK_THAT(text, contains("scenes    3, 1 without an optimum\n"));
  CHECK(lines(text) == 4);
  CHECK_THAT(scene_table(study_of(3), optima, false),
             contains("scenes    3, 1 not done or without an optimum\n"));
  CHECK(scene_table(study_of(2), std::vector<SceneOptimum>(2), true) ==
        "scenes    2, 2 without an optimum");
}
