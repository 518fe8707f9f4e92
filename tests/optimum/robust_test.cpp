#include "trebsweep/optimum/robust.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr int width = 21;

/// The smallest of the values on a lattice of a box, and their mean by Simpson's rule.
Robustness brute_force(const Job& job, const Design<double>& design, double deviation) {
  const auto designs = cube(design, 2 * deviation / (width - 1), width);
  const auto values = accurate_objectives(job, designs);
  const auto weight = [](int i) {
    const int simpson = i == 0 || i == width - 1 ? 1 : i % 2 == 1 ? 4 : 2;
    return simpson / (3.0 * (width - 1));
  };
  double mean = 0;
  for (int n = 0; n < width * width * width; ++n)
    mean += weight(n / width / width) * weight(n / width % width) * weight(n % width) *
            values[static_cast<std::size_t>(n)];
  return {*std::ranges::min_element(values), mean, {}};
}

Robustness robustness(const Job& job, const Design<double>& design, double deviation) {
  std::uint64_t integrated = 0;
  const Parameters parameters = to_parameters(design);
  return robustness(design_problem(job, parameters), parameters, deviation, integrated);
}

}  // namespace

TEST_CASE("Worst and expected value agree with brute force over the box to 1e-6") {
  const Job speed, range = job_with({{"optimum.objective", "range"}});
  const Job fixed = job_with({{"lattice.r3", "0.6"}});  // may be off all the same
  for (const Job& job : {speed, range, fixed})
    for (const Design<double>& design :
         {Design<double>{0.52, 0.6, 0.9}, Design<double>{0.8, 0.6, 0.7}}) {
      const auto found = robustness(job, design, 0.01), exact = brute_force(job, design, 0.01);
      CHECK(found.worst <= exact.worst + 1e-9);
      CHECK(found.worst == Approx(exact.worst).epsilon(0).margin(1e-6));
      CHECK(found.expected == Approx(exact.expected).epsilon(0).margin(1e-6));
    }
}

TEST_CASE("A worst value inside the box is found between the points of a lattice") {
  // The range has a minimum where the projectile flies straight up.
  const Job job = job_with({{"optimum.objective", "range"}, {"optimum.subject-to", "speed >= 1"}});
  const Design<double> design{0.7, 0.9, 0.5};
  const auto found = robustness(job, design, 0.05), exact = brute_force(job, design, 0.05);
  CHECK(found.worst <= exact.worst + 1e-9);
  CHECK(found.worst == Approx(exact.worst).epsilon(1e-3));
}

TEST_CASE("The designs that the worst and the expected value take are counted") {
  std::uint64_t integrated = 0;
  const Parameters parameters = to_parameters({0.52, 0.6, 0.9});
  robustness(design_problem(Job{}, parameters), parameters, 0.01, integrated);
  CHECK(integrated > 9 * 9 * 9);  // the lattice on which the search for the worst value starts
  CHECK(integrated < 10'000);
}

TEST_CASE("There is no robustness where a design in the box has no release") {
  const auto found = robustness(Job{}, {0.505, 0.58, 0.9}, 0.01);  // r1 < h - h0 = 0.5 m
  CHECK(std::isnan(found.worst));
  CHECK(std::isnan(found.expected));
  REQUIRE(found.unreleased);
  CHECK((*found.unreleased)(0) <= 0.5);
  CHECK_FALSE(robustness(Job{}, {0.52, 0.58, 0.9}, 0.01).unreleased);
}

TEST_CASE("A robust search leaves room for the deviation above the bounds of what is possible") {
  const Job paper, raised = job_with({{"lattice.r1", "0.55:1:0.01"}});
  const auto space_of = [](const Job& job, double deviation) {
    return robust_space(job, design_space(job), deviation);
  };
  CHECK(space_of(paper, 0.01).lower[0] == Approx(0.51).epsilon(1e-9));  // h - h0 = 0.5 m
  CHECK(space_of(paper, 0.01).lower[0] > 0.51);
  CHECK(space_of(paper, 0.01).lower[2] == Approx(0.01).epsilon(1e-9));
  CHECK(space_of(raised, 0.01).lower[0] == 0.55);
  CHECK(space_of(job_with({{"lattice.r1", "0.505"}}), 0.01).lower[0] == 0.505);  // is kept
}

TEST_CASE("No design nearby has a better worst case or expected value than the one found",
          "[slow]") {
  constexpr double deviation = 0.005;
  const Job plain;
  const Job limited = job_with({{"optimum.subject-to", "peak-axle-load <= 1.6e5"}});
  for (const Job& job : {plain, limited})
    for (const Robust robust : {Robust::worst, Robust::expected}) {
      if (!job.optimum.constraints.empty() && robust == Robust::expected) continue;  // seconds
      const DesignProblem problem = design_problem(job, to_parameters({0.55, 0.6, 0.85}));
      std::uint64_t integrated = 0;
      const auto merit = [&](const Design<double>& design) {
        const auto [worst, expected, unreleased] =
            robustness(problem, to_parameters(design), deviation, integrated);
        return robust == Robust::worst ? worst : expected;
      };
      const auto is_allowed = [&](const Design<double>& design) {
        if (sum_excess(job, design) > 1e-12) return false;
        for (const Constraint& c : problem.constraints)
          for (const double value :
               accurate_values(job, c.expression.fields.front(), cube(design, deviation, 3)))
            if (!(violation(c, value) <= 1e-7 * std::abs(c.limit))) return false;
        return true;
      };
      const KktPoint found =
          robust_search(problem, to_parameters({0.55, 0.6, 0.85}), robust, deviation, integrated);
      REQUIRE(is_feasible(found.point));
      const Design<double> design = to_design(to_parameters(problem, found.point.x));
      CHECK(is_allowed(design));
      const double best = merit(design);
      CHECK(found.point.objective * problem.scales[0] == Approx(best).epsilon(1e-9));
      for (const Design<double>& other : cube(design, 1e-3, 3))
        if (is_allowed(other)) CHECK(merit(other) <= best + 1e-9);
    }
}

TEST_CASE("A constraint holds where its worst case lies within the box of deviations") {
  constexpr double deviation = 0.03, limit = 15;
  const Job job = job_with({{"optimum.objective", "efficiency"},
                            {"optimum.subject-to", "speed <= 15"},
                            {"lattice.r1", "0.56:1:0.11"}});
  const Parameters start = to_parameters({0.7, 0.5, 0.8});
  const DesignProblem problem = design_problem(job, start);
  std::uint64_t integrated = 0;
  const KktPoint found = robust_search(problem, start, Robust::worst, deviation, integrated);
  REQUIRE(found.converged);
  const Design<double> design = to_design(to_parameters(problem, found.point.x));
  const auto largest_of = [&](int width) {
    const auto box = cube(design, 2 * deviation / (width - 1), width);
    const auto speeds = accurate_values(job, Field::speed, box);
    return *std::max_element(speeds.begin(), speeds.end());
  };
  CHECK(largest_of(21) < limit + 1e-7);
  CHECK(largest_of(21) > limit - 1e-3);          // the constraint is active
  CHECK(largest_of(2) < largest_of(21) - 1e-3);  // not at a vertex
}
