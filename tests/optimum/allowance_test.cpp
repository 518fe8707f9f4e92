#include "trebsweep/optimum/allowance.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/optimum/report.hpp"

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

TEST_CASE("At an allowance 1 % of the value is lost, or a bound is reached, and not before") {
  for (const std::string objective : {"speed", "range", "peak-axle-load"}) {
    const Job job = job_with({{"optimum.objective", objective}});
    const double least = 0.99 * value_with(job, best, 0, 0);
    const auto all = allowances(job, best);
    for (std::size_t d = 0; d < 3; ++d)
      for (const double sign : {-1.0, 1.0}) {
        const double allowance = sign < 0 ? all[d].shorter : all[d].longer;
        if (std::isfinite(allowance) &&
            (sign < 0 ? all[d].shorter_limit : all[d].longer_limit).empty())
          CHECK(value_with(job, best, d, sign * allowance) == Approx(least).epsilon(1e-5));
        const double reach = std::min(allowance, lengths(best)[d] / 2);
        for (int i = 0; i < 20; ++i) CHECK(value_with(job, best, d, sign * reach * i / 20) > least);
      }
  }
}

TEST_CASE("An allowance ends at the bounds of the design space, and says which") {
  const auto speed = allowances(Job{}, best);  // r2 + r3 = 1.5 m
  CHECK(speed[0].shorter_limit.empty());
  CHECK(speed[0].longer_limit.empty());
  for (const std::size_t d : {1u, 2u}) {
    CHECK(speed[d].shorter > 0.01);
    CHECK(speed[d].shorter_limit.empty());
    CHECK(speed[d].longer == Approx(0).margin(1e-12));
    CHECK(speed[d].longer_limit == "r2 + r3 <= 1.5");
  }
  // The arm's angle at the release is given, so that nothing is lost.
  const auto angle = allowances(job_with({{"optimum.objective", "arm-angle"},
                                          {"lattice.r1", "1.1:1.21:0.01"},
                                          {"lattice.r2", "0.89:0.94:0.01"}}),
                                {1.2, 0.4, 0.9});
  CHECK(angle[0].shorter == Approx(0.1));
  CHECK(angle[0].shorter_limit == "r1 >= 1.1");
  CHECK(angle[0].longer == Approx(0.01));
  CHECK(angle[0].longer_limit == "r1 <= 1.21");
  CHECK(angle[1].shorter == Approx(0.1));
  CHECK(angle[1].shorter_limit == "r3 >= 0.3");
  CHECK(std::isinf(angle[1].longer));  // an explicit axis of r2 replaces r2 + r3 <= h0
  CHECK(angle[2].shorter == Approx(0.01));
  CHECK(angle[2].shorter_limit == "r2 >= 0.89");
  CHECK(angle[2].longer == Approx(0.04));
  CHECK(angle[2].longer_limit == "r2 <= 0.94");
}

TEST_CASE("An allowance ends where a constraint is violated, and says which") {
  const Design<double> design{0.6, 0.4, 0.8};  // r1 is far from its bound
  const Job plain = job_with({{"optimum.objective", "peak-beam-stress"}});
  const double limit = 1.002 * value_with(plain, design, 0, 0);  // less than 1 % above the value
  const std::string constraint = fmt::format("peak-beam-stress <= {}", limit);
  const Job job = job_with({{"optimum.subject-to", constraint + ", least-sling-tension >= -1e9"}});
  const auto free = allowances(job, design), unlimited = allowances(Job{}, design);
  int ends = 0;
  for (std::size_t d = 0; d < 3; ++d)
    for (const double sign : {-1.0, 1.0}) {
      const auto side = [&](const Allowance& a) {
        return sign < 0 ? std::pair(a.shorter, a.shorter_limit)
                        : std::pair(a.longer, a.longer_limit);
      };
      const auto [length, text] = side(free[d]);
      INFO(d << ' ' << sign << ' ' << length << ' ' << text);
      if (text == constraint) {
        ++ends;
        CHECK(length < side(unlimited[d]).first);
        CHECK(value_with(plain, design, d, sign * length) == Approx(limit).epsilon(1e-6));
      } else {
        CHECK(side(free[d]) == side(unlimited[d]));
      }
    }
  CHECK(ends >= 3);
}

TEST_CASE("An active constraint leaves no allowance on its forbidden side") {
  const Design<double> design{0.6, 0.4, 0.8};
  const Job plain = job_with({{"optimum.objective", "peak-beam-stress"}});
  const std::string constraint =
      fmt::format("peak-beam-stress <= {}", value_with(plain, design, 0, 0) * (1 + 1e-11));
  const auto all = allowances(job_with({{"optimum.subject-to", constraint}}), design);
  const auto grows = [&](std::size_t d) {
    return value_with(plain, design, d, 1e-4) > value_with(plain, design, d, -1e-4);
  };
  for (std::size_t d = 0; d < 3; ++d) {
    CHECK((grows(d) ? all[d].longer : all[d].shorter) == Approx(0).margin(1e-6));
    CHECK((grows(d) ? all[d].longer_limit : all[d].shorter_limit) == constraint);
    CHECK((grows(d) ? all[d].shorter : all[d].longer) > 1e-3);
  }
}

TEST_CASE("The value of a fixed length is not a bound, but limits end its allowance") {
  const Design<double> design{0.6, 0.4, 0.8};
  const auto free = allowances(Job{}, design);
  const auto fixed = allowances(job_with({{"lattice.r1", "0.6"}}), design);
  CHECK(fixed[0].shorter == Approx(free[0].shorter).margin(1e-6));
  CHECK(fixed[0].longer == Approx(free[0].longer).margin(1e-6));
  CHECK(free[0].shorter_limit == "r1 >= 0.5");
  CHECK(fixed[0].shorter_limit == "no release");  // with r1 <= 0.5 m
  const auto sling = allowances(job_with({{"lattice.r3", "0.58339719"}}), best);
  CHECK(sling[1].shorter > 0.01);
  CHECK(sling[1].longer_limit == "r2 + r3 <= 1.5");
}

TEST_CASE("The report names what ends an allowance") {
  OptimumResult result{};
  result.objective = Field::speed;
  result.allowances = {{{0.0109, 0.0151, "r1 >= 0.5", ""},
                        {0.0156, HUGE_VAL},
                        {0.0166, 0, "no release", "r2 + r3 <= 1.5"}}};
  result.maxima = {{best, 1, 1, true}};
  const std::string text = to_text(result, Job{});
  CHECK_THAT(text, contains("r1: 0.0109 m shorter (r1 >= 0.5) or 0.0151 m longer; gradient"));
  CHECK_THAT(text, contains("r3: 0.0156 m shorter or any length longer; gradient"));
  CHECK_THAT(text,
             contains("r2: 0.0166 m shorter (no release) or 0.0000 m longer (r2 + r3 <= 1.5); "));
  const auto json = nlohmann::json::parse(to_json(result, Job{}));
  CHECK(json["one_percent_loss"].dump() == "[[0.0109,0.0151],[0.0156,null],[0.0166,0.0]]");
  CHECK(json["one_percent_limit"].dump() ==
        R"([["r1 >= 0.5",null],[null,null],["no release","r2 + r3 <= 1.5"]])");
}

TEST_CASE("The allowance ends where there is no release") {
  // No start with r1 < h - h0 = 0.5 m.
  const Allowance r1 = allowances(Job{}, {0.501, 0.58, 0.91})[0];
  CHECK(r1.shorter == Approx(0.001).margin(1e-6));
  CHECK(r1.shorter_limit == "r1 >= 0.5");
  CHECK(r1.longer > 0.001);
  const Allowance fixed = allowances(job_with({{"lattice.r1", "0.501"}}), {0.501, 0.58, 0.91})[0];
  CHECK(fixed.shorter == Approx(0.001).margin(1e-6));
  CHECK(fixed.shorter_limit == "no release");
}

TEST_CASE("A length that may be off by more than half of it has an infinite allowance") {
  // The arm's angle at the release is given.
  const auto all = allowances(job_with({{"optimum.objective", "arm-angle"},
                                        {"lattice.r3", "0.1:2:0.1"},
                                        {"lattice.r2", "0.1:2:0.1"}}),
                              {1.2, 0.6, 0.9});
  for (const Allowance& allowance : {all[1], all[2]}) {
    CHECK(std::isinf(allowance.shorter));
    CHECK(std::isinf(allowance.longer));
  }
}
