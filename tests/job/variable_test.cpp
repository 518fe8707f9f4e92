#include "trebsweep/job/variable.hpp"

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/rules.hpp"

using namespace trebsweep;

namespace {

const std::string key = "optimum.variables";

Variable variable(const std::string& text) { return to_variable(key, text); }

}  // namespace

TEST_CASE("A variable is a numeric key of the scene, or an angle of the release, with two bounds") {
  const Variable hanger = variable("counterweight-hanger 0.2:1");
  CHECK(hanger.key == "scene.counterweight-hanger");
  CHECK(hanger.lower == 0.2);
  CHECK(hanger.upper == 1);
  CHECK(unit_of(hanger) == "m");
  CHECK(to_text(hanger) == "counterweight-hanger 0.2:1");
  CHECK(variable("pin-angle 0.2 : 1").key == "solver.pin-angle");
  CHECK(unit_of(variable("drag-coefficient 0.2:1")).empty());
  const Variable angle = variable("start-angle 30 deg:90 deg");
  CHECK(angle.upper == Approx(1.5707963267948966).epsilon(1e-15));
  CHECK(variable("counterweight-mass 100 lb:200 lb").lower == 45.359237);
  CHECK(to_text(variable(to_text(angle))) == to_text(angle));
}

TEST_CASE("What is not a variable is refused, and the message says why") {
  for (const std::string text :
       {"", "hanger 0.2:1", "r1 0.2:1", "trough 0:1", "tolerance 0.1:0.2", "counterweight-hanger",
        "counterweight-hanger 0.2", "counterweight-hanger 0.2:0.4:1", "counterweight-hanger :1"}) {
    INFO(text);
    CHECK_THROWS_WITH(variable(text), contains(key + " = " + text + ": must be KEY LOW:HIGH, "));
  }
  CHECK_THROWS_WITH(variable("counterweight-hanger 1:0.2"), contains("a lower bound below"));
  CHECK_THROWS_WITH(variable("counterweight-hanger 1:1"), contains("a lower bound below"));
  CHECK_THROWS_WITH(variable("counterweight-mass -5:10"),
                    contains("counterweight-mass = -5: must"));
  CHECK_THROWS_WITH(variable("counterweight-mass 1 ft:2 ft"), contains("1 ft: must be"));
  CHECK_THROWS_WITH(variable("counterweight-mass 1:2 kg"), contains("must be"));
}

TEST_CASE("Variables that a job cannot have are refused") {
  const auto refusal = [](const std::string& variables, const std::string& others = "") {
    return [=] { parse(others + "[optimum]\nvariables = " + variables + "\n"); };
  };
  const std::string hinged = "[scene]\ncounterweight-hanger = 0.1\n";
  CHECK_NOTHROW(refusal("counterweight-hanger 0.1:0.2")());
  CHECK_THROWS_WITH(refusal("wind -5:5")(), contains("variables = wind -5:5: must be without "
                                                     "scene.wind, which must be left out unless"));
  CHECK_THROWS_WITH(refusal("pin-angle 0.1:1")(), contains("without solver.pin-angle"));
  CHECK_THROWS_WITH(refusal("counterweight-hanger 0:1", hinged)(), contains("above 0"));
  CHECK_THROWS_WITH(refusal("gravity 9:10, gravity 8:9")(), contains("given only once"));
  CHECK_THROWS_WITH(refusal("gravity 9:10", "[scene]\ngravity = 1, 9.8\n")(),
                    contains("left out with several values of scene.gravity"));
  CHECK_THROWS_WITH(refusal("trough-height 0:2", "[scene]\ntrough = yes\n")(),
                    contains("scene.trough-height = 2: must be below scene.fulcrum-height"));
  CHECK_THROWS_WITH(refusal("start-angle 0.5:1", "[scene]\nrelease-height = 2\n")(),
                    contains("scene.release-height = 2: must be left out with scene.start-angle"));
  CHECK_THROWS_WITH(
      refusal("gravity 9:10, counterweight-mass 1:2, projectile-mass 1:2, fulcrum-height 1:2, "
              "beam-density 1:2, beam-side 0.1:0.2, sling-mass 1:2, release-height 1:2, "
              "pivot-viscosity 1:2")(),
      contains("at most 8 variables"));
}

TEST_CASE("Without a value of its own, a variable has the middle of its bounds, also read again") {
  const std::string given = "[optimum]\nvariables = start-angle 0.5:1, gravity 9:10\n";
  const Job job = parse(given), own = parse("[scene]\ngravity = 9.2\n" + given);
  CHECK(job.scene.start_angle == 0.75);
  CHECK(job.scene.gravity == 9.5);
  CHECK(own.scene.gravity == 9.2);
  CHECK(to_text(parse(to_text(job))) == to_text(job));
}

TEST_CASE("Variables are set in the scene and the solver, and a key allows values beyond bounds") {
  const std::vector<Variable> variables{variable("gravity 9:10"), variable("release-angle 3:3.5"),
                                        variable("pin-angle 0.1:1")};
  Scene scene;
  Solver solver;
  set_variables(variables, std::array{9.25, 3.25, 0.5}, scene, solver);
  CHECK(scene.gravity == 9.25);
  CHECK(solver.release_angle == 3.25);
  CHECK(solver.pin_angle == 0.5);
  CHECK(allows(variables[0], 11));
  CHECK_FALSE(allows(variables[0], -1));
  CHECK(corners(variables).size() == 8);
  CHECK(corners(variables)[5] == std::vector{10.0, 3.0, 1.0});
}
