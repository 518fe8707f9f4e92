#include "trebsweep/optimum/allowance.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/optimum/json_report.hpp"
#include "trebsweep/optimum/report.hpp"

using namespace trebsweep;

namespace {

const Design<double> best{0.51142299, 0.58339719, 0.91660281};  // the paper's optimum

std::vector<Allowance> allowances(const Job& job, const Design<double>& design) {
  std::uint64_t integrated = 0;
  const Parameters parameters = to_parameters(design);
  const auto all = allowances(design_problem(job, parameters), parameters, integrated);
  CHECK(integrated > 0);
  return all;
}

/// The value at a design of which one length differs.
double value_with(const Job& job, Design<double> design, std::size_t length, double by) {
  (length == 0 ? design.r1 : length == 1 ? design.r3 : design.r2) += by;
  return accurate_objective(job, design);
}

}  // namespace

TEST_CASE("At an allowance 1 % of the value is lost, or a bound is reached, and not before") {
  for (const std::string objective : {"speed", "range", "peak-axle-load"}) {
    const Job job = job_with({{"optimum.objective", objective}});
    const double least = 0.99 * value_with(job, best, 0, 0);
    const auto all = allowances(job, best);
    for (std::size_t d = 0; d < 3; ++d)
      for (const double sign : {-1.0, 1.0}) {
        const double allowance = sign < 0 ? all[d].less : all[d].more;
        if (std::isfinite(allowance) && (sign < 0 ? all[d].less_limit : all[d].more_limit).empty())
          CHECK(value_with(job, best, d, sign * allowance) == Approx(least).epsilon(1e-5));
        const double reach =
            std::min(allowance, to_parameters(best)(static_cast<Eigen::Index>(d)) / 2);
        for (int i = 0; i < 20; ++i) CHECK(value_with(job, best, d, sign * reach * i / 20) > least);
      }
  }
}

TEST_CASE("An allowance ends at the bounds of the design space, and says which") {
  const auto speed = allowances(Job{}, best);  // r2 + r3 = 1.5 m
  CHECK(speed[0].less_limit.empty());
  CHECK(speed[0].more_limit.empty());
  for (const std::size_t d : {1u, 2u}) {
    CHECK(speed[d].less > 0.01);
    CHECK(speed[d].less_limit.empty());
    CHECK(speed[d].more == Approx(0).margin(1e-12));
    CHECK(speed[d].more_limit == "r2 + r3 <= 1.5");
  }
  // The arm's angle at the release is given, so that nothing is lost.
  const auto angle = allowances(job_with({{"optimum.objective", "arm-angle"},
                                          {"lattice.r1", "1.1:1.21:0.01"},
                                          {"lattice.r2", "0.89:0.94:0.01"}}),
                                {1.2, 0.4, 0.9});
  CHECK(angle[0].less == Approx(0.1));
  CHECK(angle[0].less_limit == "r1 >= 1.1");
  CHECK(angle[0].more == Approx(0.01));
  CHECK(angle[0].more_limit == "r1 <= 1.21");
  CHECK(angle[1].less == Approx(0.1));
  CHECK(angle[1].less_limit == "r3 >= 0.3");
  CHECK(std::isinf(angle[1].more));  // an explicit axis of r2 replaces r2 + r3 <= h0
  CHECK(angle[2].less == Approx(0.01));
  CHECK(angle[2].less_limit == "r2 >= 0.89");
  CHECK(angle[2].more == Approx(0.04));
  CHECK(angle[2].more_limit == "r2 <= 0.94");
}

TEST_CASE("A limit that a design is beyond by rounding does not end other allowances") {
  Design<double> design = best;
  design.r2 = std::nextafter(1.5 - design.r3, 2);
  const auto exact = allowances(Job{}, best), rounded = allowances(Job{}, design);
  CHECK(rounded[0].less == Approx(exact[0].less).epsilon(1e-5));
  CHECK(rounded[0].less_limit.empty());
  CHECK(rounded[2].more == Approx(0).margin(1e-9));
  CHECK(rounded[2].more_limit == "r2 + r3 <= 1.5");
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
        return sign < 0 ? std::pair(a.less, a.less_limit) : std::pair(a.more, a.more_limit);
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
    CHECK((grows(d) ? all[d].more : all[d].less) == Approx(0).margin(1e-6));
    CHECK((grows(d) ? all[d].more_limit : all[d].less_limit) == constraint);
    CHECK((grows(d) ? all[d].less : all[d].more) > 1e-3);
  }
}

TEST_CASE("The value of a fixed length is not a bound, but limits end its allowance") {
  const Design<double> design{0.6, 0.4, 0.8};
  const auto free = allowances(Job{}, design);
  const auto fixed = allowances(job_with({{"lattice.r1", "0.6"}}), design);
  CHECK(fixed[0].less == Approx(free[0].less).margin(1e-6));
  CHECK(fixed[0].more == Approx(free[0].more).margin(1e-6));
  CHECK(free[0].less_limit == "r1 >= 0.5");
  CHECK(fixed[0].less_limit == "no release");  // with r1 <= 0.5 m
  const auto sling = allowances(job_with({{"lattice.r3", "0.58339719"}}), best);
  CHECK(sling[1].less > 0.01);
  CHECK(sling[1].more_limit == "r2 + r3 <= 1.5");
}

TEST_CASE("The report names what ends an allowance") {
  OptimumResult result{};
  result.objective = to_expression(Field::speed);
  result.parameters = to_parameters(best);
  result.gradient = Eigen::Vector3d::Zero();
  result.hessian = Eigen::Matrix3d::Zero();
  result.allowances = {{0.0109, 0.0151, "r1 >= 0.5", ""},
                       {0.0156, HUGE_VAL},
                       {0.0166, 0, "no release", "r2 + r3 <= 1.5"}};
  result.maxima = {{result.parameters, 1, 1, true}};
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
  CHECK(r1.less == Approx(0.001).margin(1e-6));
  CHECK(r1.less_limit == "r1 >= 0.5");
  CHECK(r1.more > 0.001);
  const Allowance fixed = allowances(job_with({{"lattice.r1", "0.501"}}), {0.501, 0.58, 0.91})[0];
  CHECK(fixed.less == Approx(0.001).margin(1e-6));
  CHECK(fixed.less_limit == "no release");
}

TEST_CASE("A length that may be off by more than half of it has an infinite allowance") {
  // The arm's angle at the release is given.
  const auto all = allowances(job_with({{"optimum.objective", "arm-angle"},
                                        {"lattice.r3", "0.1:2:0.1"},
                                        {"lattice.r2", "0.1:2:0.1"}}),
                              {1.2, 0.6, 0.9});
  for (const Allowance& allowance : {all[1], all[2]}) {
    CHECK(std::isinf(allowance.less));
    CHECK(std::isinf(allowance.more));
  }
}

TEST_CASE(
    "At the allowance of the pin's angle 1 % is lost or a constraint reached, and not before") {
  const std::string machine =
      "[scene]\nfulcrum-height = 1.1\ncounterweight-mass = 60\nprojectile-mass = 0.5\n"
      "beam-side = 0.06\nbeam-density = 500\nstart-angle = 0.8\n"
      "counterweight-hanger = 0.4\ntrough = yes\n[solver]\nrelease = farthest\n";
  const Design<double> design{0.5, 1.3, 1.5};
  for (const std::string optimum : {"objective = range", "objective = speed",
                                    "objective = range\nsubject-to = peak-sling-tension <= 312"}) {
    Job job = job_from(machine + "[optimum]\n" + optimum);
    const double angle = accurate_value(job, Field::pin_angle, design);
    std::uint64_t integrated = 0;
    const auto pin = pin_allowance(design_problem(job, to_parameters(design)),
                                   to_parameters(design), integrated);
    REQUIRE(pin);
    job.solver.release = Release::pin;
    const Field objective = field_of(job.optimum.objective).value();
    const auto value_at = [&](double by, Field field) {
      job.solver.pin_angle = angle + by;
      return accurate_value(job, field, design);
    };
    const double least = 0.99 * value_at(0, objective);
    for (const double sign : {-1.0, 1.0}) {
      const double off = sign < 0 ? pin->less : pin->more;
      const std::string& limit = sign < 0 ? pin->less_limit : pin->more_limit;
      INFO(optimum << ' ' << sign * off << ' ' << limit);
      if (!limit.empty())
        CHECK(value_at(sign * off, Field::peak_sling_tension) == Approx(312).epsilon(1e-5));
      else if (std::isfinite(off))
        CHECK(value_at(sign * off, objective) == Approx(least).epsilon(1e-5));
      for (int i = 0; i < 10; ++i)
        CHECK(value_at(sign * std::min(off, 1.0) * i / 10, objective) > least);
    }
  }
}

TEST_CASE("A release that no pin makes has no allowance of the pin's angle") {
  const Job job = job_with({{"solver.release-angle", "0.5"}});  // phi1 - phi2 still grows
  std::uint64_t integrated = 0;
  const Parameters parameters = to_parameters(best);
  CHECK_FALSE(pin_allowance(design_problem(job, parameters), parameters, integrated));
}
