#include "trebsweep/archive/summary.hpp"

#include <limits>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

SwingResult released(double speed, double time) { return {speed, time, 10, Status::released}; }

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

const Study paper_study{Job{}};

}  // namespace

TEST_CASE("The optimum has the largest objective, and of equal ones is the first in the lattice") {
  Tally tally;
  tally.add(released(8, 0.1), 0, -9);
  tally.add(released(7, 0.6), 1000, -3);
  tally.add(released(7, 0.5), 999, -3);
  tally.add({99, 0, 5, Status::not_released}, 0, 99);
  const Summary summary = to_summary(tally, paper_study);
  CHECK(summary.designs() == 4);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::released)] == 3);
  CHECK(summary.statuses[static_cast<std::size_t>(Status::not_released)] == 1);
  CHECK(summary.steps == 35);
  REQUIRE(summary.optimum);
  CHECK(summary.first_of_statuses ==
        std::vector(2, PlacedDesign{0, paper_study.lattice(0).design({0, 0, 0})}));
  CHECK(summary.optimum->value == -3);
  CHECK(summary.optimum->speed == 7);
  CHECK(summary.optimum->release_time == 0.5);
  CHECK(summary.optimum->design == paper_study.lattice(0).design({0, 999 / 119, 999 % 119}));
}

TEST_CASE("Without a release the summary has no optimum, and its text reports that") {
  Tally tally;
  tally.add({no_value, no_value, 1, Status::non_finite}, 0, no_value);
  const Summary summary = to_summary(tally, paper_study);
  CHECK_FALSE(summary.optimum);
  CHECK_THAT(to_text(summary, Job{}),
             contains("non_finite") && contains("optimum   none: nothing was released\n"));
}

TEST_CASE("If released designs are excluded, the text says by what") {
  Tally tally;
  tally.add(released(7, 0.5), 0, no_value);
  const Summary summary = to_summary(tally, paper_study);
  CHECK_FALSE(summary.optimum);
  Job job;
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a taut sling\n"));
  job.optimum = {Field::range, {{Field::apex, true, 3}}};
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a finite range and has a taut sling "
                      "and satisfies the constraints\n"));
}

TEST_CASE("The optimum's objective is printed with its unit, and so are the constraints") {
  Summary summary;
  summary.optimum = Optimum{{0.5, 0.58, 0.91}, 27.01, 15.5, 0.75};
  const std::string place = " at r1 = 0.5, r2 = 0.91, r3 = 0.58 m, released at 0.75 s";
  Job job;
  CHECK_THAT(to_text(summary, job), contains("optimum   15.50000000 m/s" + place + "\n"));
  job.optimum.objective = Field::range;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   range 27.01 m" + place + " with 15.50000000 m/s\n"));
  job.optimum = {Field::efficiency,
                 {{Field::peak_axle_load, true, 150000}, {Field::least_sling_tension, false, 0}}};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   efficiency 27.01" + place +
                      " with 15.50000000 m/s, the sling taut, subject to peak-axle-load <= 150000, "
                      "least-sling-tension >= 0\n"));
}

TEST_CASE("The text gives the measured error") {
  Summary summary;
  CHECK_THAT(to_text(summary, Job{}), contains("error     not measured\n"));
  summary.error = MeasuredError{8e-10, 1.5e-8, 4e-9, 128};
  CHECK_THAT(to_text(summary, Job{}),
             contains("error     8e-10 median, 1.5e-08 largest of 128 designs; 4e-09 at the "
                      "optimum\n"));
  summary.error->at_optimum = no_value;
  CHECK_THAT(to_text(summary, Job{}), contains("of 128 designs\n"));
  Job job;
  job.optimum.objective = Field::range;
  CHECK_THAT(to_text(summary, job), contains("of 128 designs (of the speed, m/s)\n"));
}

TEST_CASE("The text gives the optimal design with all its digits") {
  Summary summary;
  summary.optimum = Optimum{{0.512345678, 0.58, 0.91}, 16.5, 16.5, 0.9};
  CHECK_THAT(to_text(summary, Job{}), contains("r1 = 0.512345678, r2 = 0.91, r3 = 0.58 m"));
}

TEST_CASE("The optimum of a study and its first designs of each status are in their scenes") {
  const Study study(parse_job("[scene]\nprojectile-mass = 50, 100\n", "a.cfg", {}));
  const Index3 first{0, 0, 0}, best{7, 8, 9};
  Tally tally;
  tally.add(released(7, 0.5), study.cell(1, best), 7);
  tally.add(released(6, 0.6), study.cell(1, first), 6);
  tally.add({no_value, no_value, 1, Status::non_finite}, study.cell(0, best), no_value);
  const Summary summary = to_summary(tally, study);
  REQUIRE(summary.optimum);
  CHECK(summary.optimum->scene == 1);
  CHECK(summary.optimum->design == study.lattice(1).design(best));
  CHECK(summary.first_of_statuses == std::vector<PlacedDesign>{{1, study.lattice(1).design(first)},
                                                               {0, study.lattice(0).design(best)}});
}
