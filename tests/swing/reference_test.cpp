#include "trebsweep/swing/reference.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

const Design<double> optimum{0.51, 0.58, 0.91};

Scene elastic_scene() {
  Scene scene;
  scene.sling_mass = 1;
  scene.sling_stiffness = 3e5;
  scene.sling_damping = 500;
  return scene;
}

/// A design whose elastic sling goes slack within a step, which fehlberg78 misses.
const Design<double> slack{0.53, 1.13, 0.25};

double speed_by(const std::string& stepper, const Scene& scene, const Design<double>& design) {
  Solver solver;
  solver.stepper = stepper;
  solver.tolerance = 1e-13;
  solver.max_steps = 100'000;
  SwingResult result;
  integrate(scene, solver, {{&design, 1}, {&result, 1}});
  return result.speed;
}

/// The accurate speed for a job that uses a stepper.
double accurate_speed(const std::string& stepper, const Scene& scene,
                      const Design<double>& design) {
  Solver solver;
  solver.stepper = stepper;
  SwingResult result;
  integrate_accurately(scene, solver, {{&design, 1}, {&result, 1}});
  return result.speed;
}

}  // namespace

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
  for (const Design<double>& design : {optimum, Design<double>{0.75, 3, 4}}) {
    const double truth = reference(Scene{}, design, Solver{}).speed;
    CHECK(std::abs(speed_in_extended_precision(Scene{}, design, 1e-15, Solver{}) - truth) <
          4e-16 * truth);
  }
}

TEST_CASE(
    "Where an elastic sling goes slack, speeds in extended precision and accurate ones agree") {
  const Scene scene = elastic_scene();
  const double truth = speed_by("dopri5", scene, slack);
  CHECK(std::abs(speed_by("fehlberg78", scene, slack) - truth) > 1e-6);
  CHECK(std::abs(speed_in_extended_precision(scene, slack, 1e-15, Solver{}) - truth) < 1e-11);
  for (const std::string job : {"fehlberg78", "dopri5", "vern8"})
    CHECK(std::abs(accurate_speed(job, scene, slack) - truth) < 1e-10);
}

TEST_CASE("Accurate speeds are those of another stepper than the job's") {
  for (const Scene& scene : {Scene{}, elastic_scene()})
    for (const std::string job : {"fehlberg78", "dopri5", "vern8"}) {
      const double accurate = accurate_speed(job, scene, optimum);
      CHECK(accurate != speed_by(job, scene, optimum));
      CHECK(std::abs(accurate - speed_by(job, scene, optimum)) < 1e-10);
    }
}

TEST_CASE("A reference without a release has a status and no speed") {
  Scene scene;
  scene.projectile_mass = 5000;
  const Reference r = reference(scene, optimum, paper_solver());
  CHECK(r.status == Status::not_released);
  CHECK(std::isnan(r.speed));
  CHECK(std::isnan(r.speed_bound));
  CHECK(std::isnan(speed_in_extended_precision(scene, optimum, 1e-13, paper_solver())));
}
