#include "trebsweep/sweep/objective.hpp"

#include <array>
#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

/// Three integrated designs with an efficiency, a least sling tension and a slack each.
struct ThreeDesigns {
  std::array<Design<double>, 3> designs{};
  std::array<SwingResult, 3> results{SwingResult{10, 0.5, 100, Status::released},
                                     SwingResult{11, 0.6, 110, Status::released_below_ground},
                                     SwingResult{12, 0.7, 120, Status::released}};
  std::array<Field, 3> fields{Field::efficiency, Field::least_sling_tension, Field::slack};
  std::array<double, 9> values{0.1, -5, 2, 0.2, std::nan(""), 1, 0.3, 0, 1};
  Batch batch{designs, results, fields, values};

  std::vector<double> of(Field field) const {
    std::vector<double> found;
    for_each_value(batch, field, [&](std::size_t, double value) { found.push_back(value); });
    return found;
  }

  /// The designs that have an objective.
  std::vector<std::size_t> qualifying(const Job& job) const {
    std::vector<std::size_t> found;
    const std::vector<double> all = objectives(batch, job);
    for (std::size_t n = 0; n < all.size(); ++n)
      if (!std::isnan(all[n])) found.push_back(n);
    return found;
  }
};

using Indices = std::vector<std::size_t>;

}  // namespace

TEST_CASE("A speed without constraints needs no additional field") {
  Job job;
  CHECK(additional_fields(deciding_fields(job)).empty());
  job.optimum.objective = Field::release_time;
  CHECK(additional_fields(deciding_fields(job)).empty());
}

TEST_CASE("Objective, constraints and a taut sling need their fields, each once") {
  Job job;
  job.optimum = {Field::range,
                 {{Field::range, false, 10}, {Field::speed, true, 20}, {Field::apex, true, 5}}};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(additional_fields(deciding_fields(job)) ==
        std::vector{Field::range, Field::apex, Field::slack});
}

TEST_CASE("The values of a field come from the results or from the additional fields") {
  const ThreeDesigns three;
  CHECK(three.of(Field::speed) == std::vector<double>{10, 11, 12});
  CHECK(three.of(Field::release_time) == std::vector<double>{0.5, 0.6, 0.7});
  CHECK(three.of(Field::status) == std::vector<double>{1, 7, 1});
  CHECK(three.of(Field::steps) == std::vector<double>{100, 110, 120});
  CHECK(three.of(Field::efficiency) == std::vector<double>{0.1, 0.2, 0.3});
  CHECK(three.of(Field::slack) == std::vector<double>{2, 1, 1});
  CHECK_THROWS_AS(three.of(Field::range), std::logic_error);
}

TEST_CASE("The objective is the field of the job") {
  const ThreeDesigns three;
  Job job;
  CHECK(objectives(three.batch, job) == three.of(Field::speed));
  job.optimum.objective = Field::efficiency;
  CHECK(objectives(three.batch, job) == three.of(Field::efficiency));
}

TEST_CASE("A design that violates a constraint, or whose sling goes slack, has no objective") {
  const ThreeDesigns three;
  Job job;
  job.optimum.constraints = {{Field::least_sling_tension, false, 0}};  // that of design 1 is NaN
  CHECK(three.qualifying(job) == Indices{2});
  job.optimum.constraints = {{Field::least_sling_tension, true, -5}};
  CHECK(three.qualifying(job) == Indices{0});
  job.optimum.constraints = {{Field::efficiency, false, 0.2}, {Field::speed, true, 11}};
  CHECK(three.qualifying(job) == Indices{1});
  job.optimum.constraints.clear();
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK(three.qualifying(job) == Indices{1, 2});
}
