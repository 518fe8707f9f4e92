#include "trebsweep/job/key.hpp"

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

TEST_CASE("The message about an invalid value names the key and the value, for every key") {
  for (const Key& key : job_keys()) {
    if (key.name == "output.file" || key.name == "assess.scenes" || key.name == "assess.extremes")
      continue;  // any text can be a path
    INFO(key.name);
    CHECK_THROWS_WITH(parse("", {{key.name, "nonsense"}}),
                      contains(key.name + " = nonsense: must be "));
    if (key.name != "optimum.subject-to")  // a list that may be empty
      CHECK_THROWS_AS(parse("", {{key.name, ""}}), InputError);
  }
}

TEST_CASE("Values out of range are refused") {
  const std::vector<std::pair<std::string, std::string>> bad{
      {"scene.beam-density", "-1"},
      {"scene.sling-angle", "4"},
      {"lattice.increment", "0"},
      {"lattice.increment", "-0.01"},
      {"lattice.r1", "1:0.5:0.1"},
      {"lattice.r1", "0.5:1:0"},
      {"lattice.r1", "0.5:1:-0.1"},
      {"lattice.r1", "0.5:1"},
      {"lattice.r1", "0.5:x:0.1"},
      {"lattice.r1", "0:1:0.1"},
      {"lattice.r1", "nan"},
      {"lattice.r1", "1e13"},
      {"lattice.increment", "1e-13"},
      {"solver.release-window", "10"},
      {"solver.release-window", "1.5708"},
      {"solver.release-window", "0"},
      {"solver.stepper", "Euler"},
      {"solver.tolerance", "0"},
      {"solver.tolerance", "1e-16"},
      {"solver.tolerance", "1"},
      {"solver.max-steps", "0"},
      {"solver.max-steps", "1e6"},
      {"solver.max-steps", "-5"},
      {"output.compression", "10"},
      {"output.compression", "-1"},
      {"output.compression", "1.5"},
      {"output.storage", "float16"},
      {"output.file", "a#b.h5"},
      {"output.optimum", "slack"},
      {"optimum.objective", "status"},
      {"optimum.objective", "steps"},
      {"optimum.objective", "speed, range"},
      {"optimum.subject-to", "slack <= 1"},
      {"optimum.subject-to", "speed < 3"},
      {"optimum.deviation", "-0.01"},
      {"optimum.deviation", "1e-13"},
      {"optimum.robust", "yes"},
      {"optimum.refine", "true"},
      {"scene.sling-stiffness", "-1"},
      {"scene.sling-stiffness", "1e-13"},
      {"scene.sling-stiffness", "1e13"},
      {"scene.sling-damping", "-1"},
      {"scene.pivot-viscosity", "-1"},
      {"scene.pivot-friction", "-0.1"},
      {"scene.sling-mass", "-2"},
      {"scene.beam-mass", "-1"},
      {"scene.beam-centre", "1.1e12"},
      {"scene.beam-moment", "-1"},
      {"scene.start-angle", "3.15"},
      {"scene.start-angle", "-3.15"},
      {"scene.counterweight-hanger", "-0.1"},
      {"scene.trough", "true"},
      {"scene.trough-height", "-0.1"},
      {"scene.projectile-diameter", "-0.1"},
      {"scene.drag-coefficient", "-0.47"},
      {"scene.air-density", "-1"},
      {"scene.wind", "1001"},
      {"scene.wind", "-1001"},
      {"solver.release", "hook"},
      {"solver.release-angle", "0"},
      {"solver.release-angle", "6.2832"},
      {"solver.pin-angle", "3.15"},
      {"solver.pin-angle", "-3.15"},
      {"solver.target-error", "0"},
      {"assess.steppers", "leapfrog"},
      {"assess.tolerances", "1"},
      {"assess.time-steps", "0"},
      {"assess.designs", "0"},
      {"assess.target-error", "-1"},
      {"assess.lattice-seconds", "-1"},
  };
  for (const auto& [key, value] : bad)
    CHECK_THROWS_WITH(parse("", {{key, value}}),
                      contains(key + " = " + value + ": must be ") && !contains("left out"));
}

TEST_CASE("The message about an invalid word of a list names that word only") {
  CHECK_THROWS_WITH(parse("", {{"output.fields", "speed, sped"}}),
                    contains("output.fields = sped: must be one of speed, release-time"));
  CHECK_THROWS_WITH(parse("", {{"output.fields", "speed, range, speed"}}),
                    contains("output.fields = speed: must be listed only once"));
  CHECK_THROWS_WITH(parse("", {{"assess.steppers", "rk4, rk4"}}),
                    contains("assess.steppers = rk4: must be listed only once"));
  const std::string constraints = "speed >= 1, range > 2, apex <= 3";
  CHECK_THROWS_WITH(parse("", {{"optimum.subject-to", constraints}}),
                    contains("optimum.subject-to = range > 2: must be FIELD <= NUMBER"));
  for (const std::string incomplete : {"speed >= 1,", ",speed >= 1", "speed >= 1,,apex <= 3", ","})
    CHECK_THROWS_WITH(parse("", {{"optimum.subject-to", incomplete}}),
                      contains("optimum.subject-to = : must be FIELD <= NUMBER"));
}

TEST_CASE("A message quotes at most 200 characters of a value") {
  CHECK_THROWS_WITH(parse("", {{"scene.gravity", std::string(201, '9')}}),
                    contains(std::string(200, '9') + "...: must be"));
}

TEST_CASE("The bounds in the message about an angle are allowed values") {
  CHECK_THROWS_WITH(parse("", {{"solver.release-angle", "7"}}), contains("to 6.28318531"));
  CHECK_NOTHROW(parse("", {{"solver.release-angle", "6.28318531"}}));
  CHECK_NOTHROW(parse("", {{"solver.release-angle", "6.283185307179586"}}));
  CHECK_THROWS_WITH(parse("", {{"scene.sling-angle", "4"}}), contains("to 3.14159265"));
  CHECK_NOTHROW(parse("", {{"scene.sling-angle", "3.14159265"}}));
}

TEST_CASE("The numbers of [scene], and no other keys, can have several values") {
  for (const Key& key : job_keys()) {
    INFO(key.name);
    const bool is_scene_number = key.section() == "scene" && key.placeholder == "NUMBER";
    CHECK((key.set_number != nullptr) == is_scene_number);
    Job job;
    if (is_scene_number) {
      key.set(job, "0.3, 0.2");
      REQUIRE(job.outer_axes.size() == 1);
      CHECK(job.outer_axes.front().key == key.name);
      CHECK(job.outer_axes.front().values == std::vector{0.2, 0.3});
      CHECK(key.get(job) == "0.2, 0.3");
    } else if (key.placeholder != "LIST" && key.placeholder != "PATH") {
      CHECK_THROWS_AS(key.set(job, "0.3, 0.2"), InputError);
    }
  }
}
