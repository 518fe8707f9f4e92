#include "trebsweep/optimum/allowance.hpp"

#include "optimum/jobs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;

namespace {

const Design<double> best{0.51142299, 0.58339719, 0.91660281};  // the paper's optimum

std::array<Allowance, 3> allowances(const Job& job, const Design<double>& design) {
  std::uint64_t integrated = 0;
  const auto all = allowances(design_problem(job, design), design, integrated);
  CHECK(integrated > 0);
  return all;
}

/// The value at a design of which one length differs.
double value_with(const Job& job, Design<double> design, std::size_t length, double by) {
  (length == 0 ? design.r1 : length == 1 ? design.r3 : design.r2) += by;
  return accurate_value(job, job.optimum.objective, design);
}

}  // namespace

TEST_CASE("At an allowance 1 % of the value is lost, and not before") {
  for (const std::string objective : {"speed", "range", "peak-axle-load"}) {
    const Job job = job_with({{"optimum.objective", objective}});
    const double least = 0.99 * value_with(job, best, 0, 0);
    const auto all = allowances(job, best);
    for (std::size_t d = 0; d < 3; ++d)
      for (const double sign : {-1.0, 1.0}) {
        const double allowance = sign < 0 ? all[d].shorter : all[d].longer;
        if (std::isfinite(allowance))
          CHECK(value_with(job, best, d, sign * allowance) == Approx(least).epsilon(1e-5));
        const double reach = std::min(allowance, lengths(best)[d] / 2);
        for (int i = 0; i < 20; ++i) CHECK(value_with(job, best, d, sign * reach * i / 20) > least);
      }
  }
}

TEST_CASE("The allowance ends where there is no release") {
  // No start with r1 < h - h0 = 0.5 m.
  const auto [shorter, longer] = allowances(Job{}, {0.501, 0.58, 0.91})[0];
  CHECK(shorter == Approx(0.001).margin(1e-6));
  CHECK(longer > 0.001);
}

TEST_CASE("A length that may be off by more than half of it has an infinite allowance") {
  // The arm's angle at the release is given.
  const auto all = allowances(job_with({{"optimum.objective", "arm-angle"}}), {1.2, 0.6, 0.9});
  for (const Allowance& allowance : {all[1], all[2]}) {
    CHECK(std::isinf(allowance.shorter));
    CHECK(std::isinf(allowance.longer));
  }
}
