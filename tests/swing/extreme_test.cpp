#include <boost/math/constants/constants.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <cmath>
#include <filesystem>
#include <map>

#include "support/catch.hpp"
#include "trebsweep/job/config_file.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/ode/steppers.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/spectrum.hpp"

using namespace trebsweep;

namespace {

const std::filesystem::path folder = SOURCE_DIR "/jobs/extreme";

Job extreme(const std::string& name) {
  const std::string path = folder / (name + ".cfg");
  return parse_job(read_job_file(path), path, {});
}

Design<double> design_of(const Job& job) {
  return all_designs(Lattice(job.scene, job.lattice)).front();
}

SwingResult integrate_one(const Job& job, const Solver& solver) {
  const Design<double> design = design_of(job);
  SwingResult result;
  integrate(job.scene, solver, {{&design, 1}, {&result, 1}});
  return result;
}

SwingResult integrate_one(const std::string& name) {
  const Job job = extreme(name);
  return integrate_one(job, solver_of("dopri5", 1e-11, job.solver));
}

/// The scenes that physically have no release.
bool is_released_in_truth(const std::string& name) {
  return name != "upright" && name != "heavy_projectile" && name != "balance" &&
         name != "heavy_beam" && name != "dry_pivot" && name != "viscous_pivot" &&
         name != "short_time";
}

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem());
  return names;
}

}  // namespace

TEST_CASE(
    "Every adaptive stepper finds the physical outcome of extreme scenes; no stepper invents a "
    "release") {
  CHECK(names().size() == 29);
  for (const std::string& name : names()) {
    const Job job = extreme(name);
    const SwingResult truth = integrate_one(name);
    REQUIRE(truth.status == (is_released_in_truth(name) ? Status::released : Status::not_released));
    for (const auto stepper : stepper_names) {
      const bool adaptive = follows_tolerance(stepper);
      const double value = adaptive ? job.solver.tolerance : job.solver.time_step;
      const SwingResult result =
          integrate_one(job, solver_of(std::string(stepper), value, job.solver));
      INFO(name << ", " << stepper << ": " << name_of(result.status) << " " << result.speed
                << " for " << truth.speed);
      CHECK(result.steps <= job.solver.max_steps);
      CHECK(std::isnan(result.speed) == !has_speed(result.status));
      if (!is_released_in_truth(name)) CHECK_FALSE(has_speed(result.status));
      if (!adaptive) continue;  // its step may be too long for the scene
      REQUIRE(result.status == truth.status);
      if (has_speed(result.status))
        CHECK(result.speed == Approx(truth.speed).epsilon(1e-6).margin(1e-9));
    }
  }
}

TEST_CASE("The speed with a sling of 1 mm agrees with other programs") {
  CHECK(integrate_one("sling_1mm").speed == Approx(7.44223).margin(1e-5));
  CHECK(integrate_one("sling_1mm").release_time == Approx(0.899289578).margin(1e-8));
}

TEST_CASE("Speeds scale with the square root of gravity, times with its inverse") {
  const SwingResult earth = integrate_one("narrow_window");  // the paper's optimum
  for (const auto& [name, gravity] : {std::pair("moon", 1.62), std::pair("strong_gravity", 1e4)}) {
    const double ratio = std::sqrt(gravity / 9.8);
    CHECK(integrate_one(name).speed == Approx(ratio * earth.speed).epsilon(1e-9));
    CHECK(integrate_one(name).release_time == Approx(earth.release_time / ratio).epsilon(1e-9));
  }
}

TEST_CASE("With a projectile of 1 mg the beam is a physical pendulum") {
  const Job job = extreme("light_projectile");
  const Mechanism<double> mechanism(job.scene, design_of(job));
  const double torque = job.scene.gravity * mechanism.moment(), inertia = mechanism.inertia();
  const double angle = start<double>(job.scene, design_of(job))[phi1];
  const double k = std::sin((boost::math::double_constants::pi - angle) / 2);
  CHECK(integrate_one("light_projectile").release_time ==
        Approx(boost::math::ellint_1(k) / std::sqrt(torque / inertia)).epsilon(1e-8));
}

TEST_CASE("Near the upright position, the release is delayed by the logarithm of the distance") {
  const Job job = extreme("upright_1nm");
  const auto spectrum = spectra(job.scene, design_of(job), job.solver).front();
  double fastest = 0;  // 1/s: growth rate of the unstable mode
  for (const auto& eigenvalue : spectrum.eigenvalues)
    fastest = std::max(fastest, eigenvalue.real());
  // The angle is proportional to the square root of the distance.
  const double later = std::log(std::sqrt(1e3)) / fastest;
  CHECK(integrate_one("upright_1nm").release_time - integrate_one("upright_1um").release_time ==
        Approx(later).epsilon(1e-3));
  CHECK(integrate_one("upright_1um").release_time - integrate_one("upright_1mm").release_time ==
        Approx(later).epsilon(0.02));
}

TEST_CASE("The speed vanishes with the throwing arm") {
  CHECK(integrate_one("short_arm").speed < 1e-4);
}

TEST_CASE("The speed with the stiffest slings is that of a rigid one") {
  const double rigid = integrate_one("narrow_window").speed;
  CHECK(integrate_one("elastic_1e9").speed == Approx(rigid).margin(3e-4));
  CHECK(integrate_one("elastic_1e9_damped").speed == Approx(rigid).margin(3e-4));
}

TEST_CASE("Far too long steps of euler end in a status or a large error") {
  const Job job = extreme("long_steps");
  const double truth = integrate_one("long_steps").speed;
  const SwingResult crossing =
      integrate_one(job, solver_of("euler", job.solver.time_step, job.solver));
  CHECK((!has_speed(crossing.status) || std::abs(crossing.speed - truth) > 1));
  CHECK(integrate_one(job, job.solver).status == Status::non_finite);
}

TEST_CASE("The paper's rule misses a release if the window is narrower than a step") {
  const Job job = extreme("narrow_window");
  CHECK(integrate_one(job, job.solver).status == Status::not_released);
  CHECK(integrate_one(job, solver_of("euler", 0.01, job.solver)).status == Status::released);
}
