#include "trebsweep/optimum/safety.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

namespace {

bool is_safe(const Job& job, const Design<double>& design, double deviation) {
  std::uint64_t integrated = 0;
  const Parameters parameters = to_parameters(design);
  return are_safe(design_problem(job, parameters), parameters, deviation, Accuracy::high,
                  integrated);
}

Job siege() {
  return job_with({{"scene.file", SOURCE_DIR "/jobs/scenes/siege.cfg"},
                   {"solver.release", "fastest"},
                   {"optimum.objective", "speed"},
                   {"optimum.buildable", "no"}});
}

/// The design of the siege machine, on a line along r1, in the middle of a drop from 72 to 2 m/s.
Design<double> at_steep_drop() {
  Design<double> design{.r1 = 2.4759, .r3 = 11.4625, .r2 = 5.2269};
  double fast = design.r1, slow = 2.5676;
  while (slow - fast > 1e-9) {
    design.r1 = (fast + slow) / 2;
    (accurate_value(siege(), Field::speed, design) < 37 ? slow : fast) = design.r1;
  }
  return design;
}

Design<double> longer(Design<double> design, double r1) {
  design.r1 += r1;
  return design;
}

}  // namespace

TEST_CASE("A length may be off by the job's deviation, or by a thousandth of itself") {
  const Design<double> design{.r1 = 1, .r3 = 2, .r2 = 3};
  const DesignSpace space = design_space(Job{});
  CHECK(tolerated(space, to_parameters(design), 0) == Eigen::Vector3d(0.001, 0.002, 0.003));
  CHECK(tolerated(space, to_parameters(design), 0.01) == Eigen::Vector3d(0.01, 0.01, 0.01));
}

TEST_CASE("A design is safe only at a distance from designs without a release") {
  const Design<double> design{.r1 = 0.52, .r3 = 0.58, .r2 = 0.9};  // r1 > h - h0 = 0.5 m
  CHECK(is_safe(Job{}, design, 0));
  CHECK(is_safe(Job{}, design, 0.019));
  CHECK_FALSE(is_safe(Job{}, design, 0.021));
}

TEST_CASE("A design is safe only at a distance from a steep drop of the objective") {
  const Design<double> middle = at_steep_drop();
  constexpr double deviation = 0.001;
  CHECK_FALSE(is_safe(siege(), middle, deviation));
  CHECK_FALSE(is_safe(siege(), longer(middle, -deviation / 2), deviation));
  CHECK(is_safe(siege(), longer(middle, -0.05), deviation));
}

TEST_CASE("No safe design around the one found near an unsafe one is better") {
  const Parameters unsafe = to_parameters({.r1 = 0.505, .r3 = 0.58, .r2 = 0.9});
  constexpr double deviation = 0.01;
  std::uint64_t integrated = 0;
  const auto safe =
      safe_parameters_near(design_problem(Job{}, unsafe), unsafe, deviation, integrated);
  REQUIRE(safe);
  const Design<double> found = to_design(*safe);
  CHECK(is_safe(Job{}, found, deviation));
  const double speed = accurate_value(Job{}, Field::speed, found);
  for (const Design<double>& other : cube(found, deviation / 2, 3))
    if (accurate_value(Job{}, Field::speed, other) > speed + 1e-9)
      CHECK_FALSE((is_safe(Job{}, other, deviation) && other.r2 + other.r3 <= 1.5));
  CHECK(integrated > 26 + 53);  // designs around it, and those of one check
  CHECK(integrated < 100'000);
}
