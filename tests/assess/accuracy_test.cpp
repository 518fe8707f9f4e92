#include "trebsweep/assess/accuracy.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "support/machines.hpp"
#include "support/paper_solver.hpp"
#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/integrate.hpp"
#include "trebsweep/swing/spectrum.hpp"

using namespace trebsweep;

namespace {

std::vector<Reference> references(const Scene& scene, std::span<const Design<double>> designs) {
  std::vector<Reference> all;
  for (const auto& design : designs) all.push_back(reference(scene, design, paper_solver()));
  return all;
}

}  // namespace

TEST_CASE("The paper's Euler steps overestimate the optimum's speed by 3.7 %") {
  const std::array designs{paper_optimum};
  const auto a = accuracy(Scene{}, paper_solver(), designs, references(Scene{}, designs), 1);
  CHECK(a.relative.largest == Approx(0.037).margin(0.0005));
  CHECK(a.speed.largest == Approx(17.47606519 - 16.85558691).margin(1e-7));
  CHECK(a.steps == 92);
  CHECK(a.evaluations == 92);
  CHECK(a.seconds > 0);
}

TEST_CASE("Every adaptive stepper is accurate at a tolerance of 1e-9, and its cost is counted") {
  const std::array designs{paper_optimum, Design<double>{0.8, 0.5, 0.7},
                           Design<double>{1.2, 0.9, 0.2}};
  const auto truth = references(Scene{}, designs);
  for (const std::string stepper :
       {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8", "bulirsch_stoer", "rosenbrock4"}) {
    const auto a = accuracy(Scene{}, solver_of(stepper, 1e-9, paper_solver()), designs, truth, 1);
    INFO(stepper);
    CHECK(a.status_mismatches == 0);
    CHECK(a.speed.largest < 1e-7);
    CHECK(a.time.largest < 1e-8);
    CHECK(a.drift < 1e-7);
    CHECK(a.evaluations >= 4 * a.steps);
    CHECK(a.reference_error < 1e-12);
  }
  const auto multistep = accuracy(
      Scene{}, solver_of("adams_bashforth_moulton", 0.001, paper_solver()), designs, truth, 1);
  CHECK(multistep.speed.largest < 1e-9);
}

TEST_CASE("A design that has a release in the reference only is a status mismatch") {
  const std::array designs{paper_optimum};
  Solver solver = solver_of("dopri5", 1e-6, paper_solver());
  solver.max_time = 0.5;
  const auto a = accuracy(Scene{}, solver, designs, references(Scene{}, designs), 1);
  CHECK(a.status_mismatches == 1);
  CHECK(std::isnan(a.speed.median));
}

TEST_CASE("speed-error, stiffness and decay-rate agree with separate computations") {
  const std::array designs{paper_optimum};
  const std::array fields{Field::sling_angle, Field::speed_error, Field::stiffness,
                          Field::decay_rate};
  SwingResult result;
  std::array<double, 4> values;
  integrate(Scene{}, paper_solver(), {designs, {&result, 1}, fields, values});
  CHECK(values[1] == Approx(result.speed - 16.8555869074).margin(1e-9));
  const auto [modulus, decay] = stiffness(spectra(Scene{}, paper_optimum, paper_solver()));
  CHECK(values[2] == modulus);
  CHECK(values[3] == decay);
}
