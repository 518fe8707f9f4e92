#include "trebsweep/assess/assessment_tables.hpp"

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

Case one_design(bool extreme) {
  Reference reference{};
  reference.status = Status::released;
  reference.speed = 17;
  return {"hill", Job{}, extreme, {{0.51, 0.58, 0.91}}, {reference}};
}

Measurement measurement(const Case& c, const std::string& stepper, double error, double seconds) {
  MeasuredAccuracy accuracy{};
  accuracy.statuses[static_cast<std::size_t>(Status::released)] = 1;
  accuracy.speed = accuracy.relative = accuracy.time = {error, error, error};
  accuracy.steps = 66;
  accuracy.seconds = seconds;
  return {&c, solver_of(stepper, 0.01, Solver{}), accuracy, 4};
}

}  // namespace

TEST_CASE("The advice is the fastest solver within the target error") {
  const std::vector cases{one_design(false)};
  const std::vector measured{measurement(cases[0], "euler", 1e-2, 1),
                             measurement(cases[0], "dopri5", 1e-9, 3),
                             measurement(cases[0], "rk4", 1e-7, 2)};
  CHECK_THAT(to_text(advice_table(cases, measured, 1e-6)), contains("hill   rk4"));
  CHECK_THAT(to_text(advice_table(cases, measured, 1e-12)), contains("none of these"));
}

TEST_CASE("The outcome of an extreme case is an error and steps, or a status in brackets") {
  const std::vector cases{one_design(true)};
  std::vector measured{measurement(cases[0], "rk4", 1.2e-9, 1),
                       measurement(cases[0], "dopri5", 0, 1)};
  measured[1].accuracy.statuses = {};
  measured[1].accuracy.statuses[static_cast<std::size_t>(Status::not_released)] = 1;
  measured[1].accuracy.status_mismatches = 1;
  const std::string text = to_text(outcome_table(cases, measured));
  CHECK_THAT(text, contains("17 m/s") && contains("1e-09 in 66") && contains("(not_released)"));
}

TEST_CASE("A measurement that was not made has a table without columns") {
  CHECK(growth_table(one_design(false), std::nullopt).columns.empty());
  CHECK(lattice_table(one_design(false), std::nullopt).columns.empty());
}
