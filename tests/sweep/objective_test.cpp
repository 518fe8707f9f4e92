#include "trebsweep/sweep/objective.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

using Fields = std::vector<Field>;
using Values = std::vector<double>;

/// The objective of a design whose deciding_fields() have some values.
double objective_of(const Values& values, const Job& job) {
  const Design<double> design{0.5, 0.6, 0.9};
  return objective({job.scene, design, deciding_fields(job), values}, job);
}

Constraint at_least(Field field, double limit) { return {to_expression(field), false, limit}; }
Constraint at_most(Field field, double limit) { return {to_expression(field), true, limit}; }

}  // namespace

TEST_CASE("The objective, the constraints and a taut sling decide") {
  Job job;
  CHECK(deciding_fields(job) == Fields{Field::speed});
  job.optimum.objective = to_expression(Field::range);
  job.optimum.constraints = {at_least(Field::range, 10), at_most(Field::apex, 5)};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(deciding_fields(job) == Fields{Field::range, Field::range, Field::apex, Field::slack});
}

TEST_CASE("The objective is the field of the job, and NaN without a release") {
  CHECK(objective_of(Values{10}, Job{}) == 10);
  CHECK(std::isnan(objective_of(Values{std::nan("")}, Job{})));
}

TEST_CASE("A design that violates a constraint has no objective") {
  Job job;
  job.optimum.constraints = {at_least(Field::least_sling_tension, 0)};
  CHECK(objective_of(Values{10, 0}, job) == 10);
  CHECK(std::isnan(objective_of(Values{10, -1e-9}, job)));
  CHECK(std::isnan(objective_of(Values{10, std::nan("")}, job)));
  job.optimum.constraints.push_back(at_most(Field::apex, 11));
  CHECK(objective_of(Values{10, 0, 11}, job) == 10);
  CHECK(std::isnan(objective_of(Values{10, -1, 10}, job)));
  CHECK(std::isnan(objective_of(Values{10, 1, 12}, job)));
}

TEST_CASE("If only taut slings compete, a design whose sling goes slack has no objective") {
  Job job;
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(objective_of(Values{10, 1}, job) == 10);
  CHECK(std::isnan(objective_of(Values{10, 2}, job)));
  job.optimum.constraints = {at_least(Field::range, 5)};
  CHECK(objective_of(Values{10, 6, 1}, job) == 10);
  CHECK(std::isnan(objective_of(Values{10, 6, 2}, job)));
  CHECK(std::isnan(objective_of(Values{10, 4, 1}, job)));
}

TEST_CASE("A constraint on lengths needs no field") {
  Job job;
  job.optimum.constraints = {{to_expression("r1 + r2").value(), true, 1.4}};
  CHECK(deciding_fields(job) == Fields{Field::speed});
  CHECK(objective_of({10}, job) == 10);
  job.optimum.constraints.front().limit = 1.39;
  CHECK(std::isnan(objective_of({10}, job)));
}
