#include "trebsweep/assess/stability.hpp"

#include <boost/math/constants/constants.hpp>
#include <cmath>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "trebsweep/ode/stepper_info.hpp"

using namespace trebsweep;

namespace {

/// The Taylor polynomial of exp(z): the stability function of a method with as many stages as its
/// order.
std::complex<double> taylor(const std::complex<double>& z, int degree) {
  std::complex<double> sum = 1, term = 1;
  for (int n = 1; n <= degree; ++n) sum += term *= z / static_cast<double>(n);
  return sum;
}

/// A machine with a hanger and a trough.
Scene laboratory() {
  Scene scene;
  scene.gravity = 9.81;
  scene.counterweight_mass = 53.9;
  scene.projectile_mass = 0.717;
  scene.counterweight_hanger = 0.515;
  scene.fulcrum_height = 0.831;
  scene.start_angle = 0.55;
  scene.beam_mass = 4.86;
  scene.beam_centre = 0.465;
  scene.beam_moment = 1.85;
  scene.trough = true;
  return scene;
}

Solver limits() {
  Solver solver;
  solver.release = Release::crossing;
  return solver;
}

}  // namespace

TEST_CASE("Stability functions agree with the textbook formulas") {
  for (const std::complex<double> z : {std::complex<double>{-0.7, 0.4}, {0.1, 2}, {-3, -1}}) {
    CHECK(std::abs(stability_function("euler", z) - taylor(z, 1)) < 1e-12);
    CHECK(std::abs(stability_function("modified_midpoint", z) - taylor(z, 2)) <
          std::abs(z * z * z));
    CHECK(std::abs(stability_function("rk4", z) - taylor(z, 4)) < 1e-12);
  }
  for (const auto& stepper : stepper_info) {
    if (!stepper.for_packs) continue;
    const std::complex<double> z{-0.01, 0.02};
    CHECK(std::abs(stability_function(std::string(stepper.name), z) - std::exp(z)) < 3e-4);
  }
}

TEST_CASE("rosenbrock4 is A-stable and damps stiff modes") {
  for (const double y : {0.1, 1.0, 10.0, 1e3, 1e6})
    CHECK(std::abs(stability_function("rosenbrock4", {0, y})) <= 1 + 1e-9);
  CHECK(std::abs(stability_function("rosenbrock4", {-1e6, 0})) < 1e-3);
}

TEST_CASE("Euler's method amplifies an oscillation as its stability function predicts") {
  for (const double h : {0.01, 0.001}) {
    const auto [rate, predicted, observed] = growth("euler", Scene{}, paper_optimum, h, 5);
    CHECK(predicted == Approx(std::pow(1 + h * h * rate * rate, 2.5 / h)));
    CHECK(predicted > 1.05);
    CHECK(observed == Approx(predicted).epsilon(0.01));
  }
  CHECK(growth("fehlberg78", Scene{}, paper_optimum, 0.01, 5).observed == Approx(1).margin(1e-5));
}

TEST_CASE("Near equilibrium under a heavy counterweight, arm and sling oscillate as pendulums") {
  Scene scene;
  scene.counterweight_mass = 1e12;
  scene.beam_density = 0;
  const double fastest = growth("rk4", scene, paper_optimum, 0.01, 1).rate;
  CHECK(fastest == Approx(std::sqrt(scene.gravity / paper_optimum.r1)).epsilon(1e-6));
  CHECK(growth("rk4", scene, {0.9, 0.3, 0.5}, 0.01, 1).rate ==
        Approx(std::sqrt(scene.gravity / 0.3)).epsilon(1e-6));
}

TEST_CASE("The stiffness of an overdamped sling is close to the decay rate of its damper") {
  Scene scene;
  scene.sling_stiffness = 1e6;
  scene.sling_damping = 1e7;
  const auto [modulus, decay] = stiffness(spectra(scene, paper_optimum, limits()));
  // The arm's tip moves as the sling stretches, which adds less than 10 % here.
  const double damper = scene.sling_damping / scene.projectile_mass;
  CHECK(modulus == decay);
  CHECK(decay > damper);
  CHECK(decay < 1.1 * damper);
}

TEST_CASE("In a stiff scene, steps become unusable near the largest stable step", "[slow]") {
  Scene scene;
  scene.sling_stiffness = 1e7;
  const Reference truth = reference(scene, paper_optimum, limits());
  const auto along = spectra(scene, paper_optimum, limits());
  for (const std::string stepper : {"rk4", "dopri5", "fehlberg78", "vern7", "vern8"}) {
    const double stable = largest_stable_step(stepper, along);
    const double usable = largest_usable_step(stepper, scene, paper_optimum, truth, stable);
    CHECK(usable > 0.7 * stable);
    CHECK(usable < 1.5 * stable);
  }
  CHECK(std::isinf(largest_stable_step("rosenbrock4", along)));
}

TEST_CASE("On a beam that hardly moves, a hanger oscillates as a pendulum") {
  Scene scene = laboratory();
  scene.beam_moment = 1e9;
  const auto [rate, predicted, observed] = growth("euler", scene, {0.25, 5, 0.975}, 0.01, 5);
  CHECK(rate == Approx(std::sqrt(scene.gravity / scene.counterweight_hanger)).epsilon(1e-6));
  CHECK(predicted > 1.05);
  CHECK(observed == Approx(predicted).epsilon(0.01));
}

TEST_CASE("Steppers converge at their theoretical order over whole swings, also across a lift-off",
          "[slow]") {
  using Designs = std::vector<Design<double>>;
  const auto check = [](const Scene& scene, const Designs& designs) {
    std::vector<Reference> references;
    for (const auto& design : designs) references.push_back(reference(scene, design, limits()));
    for (const StepperInfo& stepper : stepper_info) {
      // Rounding hides the order of Verner's methods, whose leading errors are small.
      if (stepper.order == 0 || stepper.name.starts_with("vern")) continue;
      INFO(stepper.name << ", trough: " << scene.trough);
      CHECK(observed_order(std::string(stepper.name), scene, designs, references) ==
            Approx(stepper.order).margin(0.2));
    }
  };
  check({}, {paper_optimum, {0.8, 0.5, 0.7}});
  check(laboratory(), {{0.25, 0.87, 0.975}, {0.2, 0.8, 0.9}, {0.3, 1, 1.1}});
}
