#include "trebsweep/optimum/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/optimum/json_report.hpp"

using namespace trebsweep;

namespace {

/// A result in which every number is different.
OptimumResult some_result() {
  OptimumResult result{};
  result.objective = to_expression(Field::range);
  result.parameters = to_parameters({0.51142299, 0.58339719, 0.91660281});
  result.value = 26.678157123456789;
  result.error = 2e-13;
  result.release_time = 0.89337;
  result.converged = true;
  result.active = {{"peak-axle-load <= 150000", "N", 1.5e-4}, {"r2 + r3 <= 1.5", "m", 9.5187}};
  result.gradient = Eigen::Vector3d(1.25, 2.5, -3.75);
  result.hessian = Eigen::MatrixXd{{-11, 12, 13}, {12, -22, 23}, {13, 23, -33}};
  result.allowances = {{0.0101, 0.0151}, {0.0156, HUGE_VAL}, {0.0166, 0.3228}};
  result.bounds = {{0.5, 1.5}, {0.3, 1.5 - 0.91660281}, {0, 1.5 - 0.58339719}};
  result.pin_allowance = {0.0317, HUGE_VAL, "", ""};
  result.range_with_wind = {25.875, 27.125};
  result.values = {{Field::pin_angle, 0.7853981633974483}};
  result.sensitivities = {{"gravity", {9.8, 0.865, 0.875}}, {"sling-mass", {0, -0.01, -0.02}}};
  result.maxima = {{result.parameters, result.value, 3, true},
                   {to_parameters({0.6, 0.7, 0.8}), 20.5, 1, true}};
  result.coarse_increment = 0.02;
  result.starts = 4;
  result.designs = 123456;
  result.seconds = 0.75;
  return result;
}

}  // namespace

TEST_CASE("The JSON object has the documented keys, and the values of the result") {
  OptimumResult result = some_result();
  const auto json = nlohmann::json::parse(to_json(result, Job{}));
  for (const char* key : {"objective", "value", "error", "r1", "r3", "r2", "release_time", "active",
                          "bounds", "job", "gradient", "hessian", "sensitivity", "worst",
                          "expected", "maxima", "coarse_increment", "designs", "seconds"})
    CHECK(json.contains(key));
  CHECK(json["constraints"].empty());
  CHECK(json["build_constraints"][3] == "least-sling-tension >= 0");
  CHECK(json["objective"] == "range");
  CHECK(json["value"] == result.value);  // to the last bit
  CHECK(json["r3"] == 0.58339719);
  CHECK(json["r2"] == 0.91660281);
  CHECK(json["active"][0]["constraint"] == "peak-axle-load <= 150000");
  CHECK(json["active"][1]["multiplier"] == 9.5187);
  CHECK(json["gradient"] == std::vector{1.25, 2.5, -3.75});
  CHECK(json["hessian"][0] == std::vector<double>{-11, 12, 13});
  CHECK(json["hessian"][2] == std::vector<double>{13, 23, -33});
  CHECK(json["sensitivity"]["gravity"] == 0.865);
  CHECK(json["sensitivity_of_optimum"]["sling-mass"] == -0.02);
  CHECK(json["bounds"][0] == std::vector{0.5, 1.5});
  CHECK(json["bounds"][1] == std::vector{0.3, 1.5 - 0.91660281});
  CHECK(json["bounds"][2] == std::vector{0, 1.5 - 0.58339719});
  CHECK(json["job"] == to_text(Job{}));
  CHECK(json["maxima"].size() == 2);
  CHECK(json["maxima"][1]["r2"] == 0.8);
  CHECK(json["designs"] == 123456);
  CHECK(json["worst"].is_null());
  CHECK(json["one_percent_loss"][1][1].is_null());  // infinite
  CHECK(json["pin_angle_loss"].dump() == "[0.0317,null]");
  CHECK(json["pin_angle_limit"].dump() == "[null,null]");
  CHECK(json["range_with_wind"]["more"] == 27.125);
  CHECK(json["units"]["pin-angle"] == "rad");
  result.robustness = Robustness{25.5, 26.25, {}};
  const auto robust = nlohmann::json::parse(to_json(result, Job{}));
  CHECK(robust["worst"] == 25.5);
  CHECK(robust["expected"] == 26.25);
}

TEST_CASE("The text has the value, the design, what each limit is worth, and the next best") {
  Job job;
  job.optimum.objective = to_expression(Field::range);
  job.optimum.deviation = 0.003;
  OptimumResult result = some_result();
  const std::string text = to_text(result, job);
  for (const std::string words :
       {"range 26.67815712 m", "r1 = 0.5114230, r2 = 0.9166028, r3 = 0.5833972 m",
        "peak-axle-load <= 150000: +0.00015 m per N", "r2 + r3 <= 1.5: +9.5187 m per m",
        "r1: 0.0101 m shorter or 0.0151 m longer", "pin angle 0.7853981634 rad (45 deg)",
        "pin: 0.0317 rad (1.816 deg) less or any angle more",
        "wind       range 25.875 m with 5 m/s less wind, 27.125 m with more", "any length longer",
        "2 found from 4 starts", "20.5 m at r1 = 0.6000000, r2 = 0.8000000, r3 = 0.7000000 m",
        "123456", "0.02 m"})
    CHECK_THAT(text, contains(words));
  CHECK_THAT(text, !contains("worst"));
  result.robustness = Robustness{25.5, 26.25, {}};
  CHECK_THAT(to_text(result, job), contains("off by up to 0.003 m: worst 25.5, expected 26.25 m"));
  CHECK_THAT(to_text(result, job), !contains("beyond an axis"));
  job.lattice.r1 = AxisRange{0.51, 0.513, 0.001};
  CHECK_THAT(to_text(result, job), contains("beyond an axis: r1 < 0.51 m, r1 > 0.513 m\n"));
  result.robustness = Robustness{NAN, NAN, to_parameters({0.5, 0.58, 0.91})};
  CHECK_THAT(to_text(result, job),
             contains("no worst value, r1 = 0.5000000, r2 = 0.9100000, r3 = 0.5800000 m has no"));
  result.active.clear();
  CHECK_THAT(to_text(result, job), contains("none is active"));
}

TEST_CASE("In customary units and in degrees, the text has the same numbers, converted") {
  Job job = job_with({{"optimum.subject-to", "peak-axle-load <= 150000"}});
  job.optimum.objective = to_expression(Field::range);
  const OptimumResult result = some_result();
  constexpr double foot = 0.3048, pound_force = 4.4482216152605;
  const std::string us = to_text(result, job, UnitSystem::us);
  for (const std::string& words :
       {fmt::format("range {:.10g} ft, error", result.value / foot),
        fmt::format("r1 = {:.7f}, r2 = {:.7f}, r3 = {:.7f} ft", 0.51142299 / foot,
                    0.91660281 / foot, 0.58339719 / foot),
        fmt::format("r2 + r3 <= {:.9g} ft: +9.5187 ft per ft", 1.5 / foot),
        fmt::format("peak-axle-load <= {:.9g} lbf: +{:.6g} ft per lbf", 150000 / pound_force,
                    1.5e-4 * pound_force / foot),
        fmt::format("{:.4f} ft shorter", 0.0101 / foot), std::string("pin angle 45 deg"),
        fmt::format("gradient +{:.4g}, curvature {:.4g}", 1.25, -11 * foot),
        fmt::format("range {:.6g} ft with {:.6g} mph less wind", 25.875 / foot, 5 / 0.44704),
        fmt::format("{:34}{:>+18.6g}", "sling-mass per lb", -0.01 * 0.45359237 / foot)})
    CHECK_THAT(us, contains(words));
  CHECK_THAT(us, !contains(" rad"));
  const std::string degrees = to_text(result, job, UnitSystem::deg);
  CHECK_THAT(degrees, contains("pin angle 45 deg\n") && contains("range 26.67815712 m"));
}

TEST_CASE("A sensitivity is per 1 % of the key, or per unit where the key is 0") {
  const std::string text = to_text(some_result(), Job{});
  const auto line = [&](const std::string& key) {
    const std::size_t start = std::min(text.find(key), text.size());
    return text.substr(start, text.find('\n', start) - start);
  };
  CHECK_THAT(line("gravity + 1 %"), contains("+0.08477") && contains("+0.08575"));
  CHECK_THAT(line("sling-mass per kg"), contains("-0.01") && contains("-0.02"));
}

TEST_CASE("The objective of optimum.minimize is shown with its own sign") {
  OptimumResult result = some_result();
  result.objective = negative(result.objective);
  result.value *= -1;
  const std::string text = to_text(result, Job{});
  for (const std::string words :
       {"optimum    least range 26.67815712 m, error", "r2 + r3 <= 1.5: -9.5187 m per m",
        "gradient -1.25, curvature +11", "the next best is -20.5 m"})
    CHECK_THAT(text, contains(words));
  CHECK_THAT(text, !contains("-(range)"));
}
