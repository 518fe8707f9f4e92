#include "trebsweep/swing/reference.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/paper_solver.hpp"

using namespace trebsweep;

TEST_CASE("References agree with other programs") {
  Scene scene;
  scene.gravity = 9.81;
  const Reference r = reference(scene, {0.75, 3, 4}, paper_solver());
  CHECK(r.status == Status::released);
  CHECK(r.speed == Approx(23.7371408230).margin(1e-9));
  CHECK(r.release_time == Approx(1.1364650403).margin(1e-9));
  CHECK(r.state[0] == Approx(3.14159265358979).margin(1e-13));
  CHECK(r.speed_bound < 1e-12);
  CHECK(r.time_bound < 1e-12);
}

TEST_CASE("Extended precision agrees with a reference to the last digit of a double") {
  for (const Design<double>& design : {Design<double>{0.51, 0.58, 0.91}, {0.75, 3, 4}}) {
    const double truth = reference(Scene{}, design, Solver{}).speed;
    CHECK(std::abs(speed_in_extended_precision(Scene{}, design, 1e-15, Solver{}) - truth) <
          4e-16 * truth);
  }
}

TEST_CASE("A reference without a release has a status and no speed") {
  Scene scene;
  scene.projectile_mass = 5000;
  const Reference r = reference(scene, {0.51, 0.58, 0.91}, paper_solver());
  CHECK(r.status == Status::not_released);
  CHECK(std::isnan(r.speed));
  CHECK(std::isnan(r.speed_bound));
  CHECK(std::isnan(speed_in_extended_precision(scene, {0.51, 0.58, 0.91}, 1e-13, paper_solver())));
}
