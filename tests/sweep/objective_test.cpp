#include "trebsweep/sweep/objective.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

using Fields = std::vector<Field>;
using Values = std::vector<double>;

TEST_CASE("The objective, the constraints and a taut sling decide") {
  Job job;
  CHECK(deciding_fields(job) == Fields{Field::speed});
  job.optimum = {Field::range, {{Field::range, false, 10}, {Field::apex, true, 5}}};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(deciding_fields(job) == Fields{Field::range, Field::range, Field::apex, Field::slack});
}

TEST_CASE("The objective is the field of the job, and NaN without a release") {
  CHECK(objective(Values{10}, Job{}) == 10);
  CHECK(std::isnan(objective(Values{std::nan("")}, Job{})));
}

TEST_CASE("A design that violates a constraint has no objective") {
  Job job;
  job.optimum.constraints = {{Field::least_sling_tension, false, 0}};
  CHECK(objective(Values{10, 0}, job) == 10);
  CHECK(std::isnan(objective(Values{10, -1e-9}, job)));
  CHECK(std::isnan(objective(Values{10, std::nan("")}, job)));
  job.optimum.constraints.push_back({Field::speed, true, 11});
  CHECK(objective(Values{10, 0, 11}, job) == 10);
  CHECK(std::isnan(objective(Values{10, -1, 10}, job)));
  CHECK(std::isnan(objective(Values{10, 1, 12}, job)));
}

TEST_CASE("If only taut slings compete, a design whose sling goes slack has no objective") {
  Job job;
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(objective(Values{10, 1}, job) == 10);
  CHECK(std::isnan(objective(Values{10, 2}, job)));
  job.optimum.constraints = {{Field::range, false, 5}};
  CHECK(objective(Values{10, 6, 1}, job) == 10);
  CHECK(std::isnan(objective(Values{10, 6, 2}, job)));
  CHECK(std::isnan(objective(Values{10, 4, 1}, job)));
}
