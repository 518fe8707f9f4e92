#include "trebsweep/cli/sweep_report.hpp"

#include <algorithm>
#include <limits>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A sweep of one scene without an optimum, whose designs all have a status.
Summary without_optimum(Status status) {
  Summary summary;
  summary.tally.statuses[static_cast<std::size_t>(status)] = 1;
  summary.optima = {BestDesign{}};
  return summary;
}

/// A sweep of one scene.
Summary with_optimum(const BestDesign& best) {
  Summary summary;
  summary.optima = {best};
  return summary;
}

BestDesign best_design(const Design<double>& design, double value) {
  return to_best_design({value, 15.5, design.r1, design.r3, design.r2, 0.75, 2e-9});
}

/// A study of projectile masses 1, 2, ...
Job study_of(int scenes) {
  Job job;
  job.outer_axes = {{"scene.projectile-mass", {}, ""}};
  for (int mass = 1; mass <= scenes; ++mass) job.outer_axes[0].values.push_back(mass);
  return job;
}

/// Its optima, whose speed is 100 / mass.
Summary summary_of(int scenes) {
  Summary summary;
  for (int mass = 1; mass <= scenes; ++mass)
    summary.optima.push_back(to_best_design({100.0 / mass, 100.0 / mass, 0.5, 0.6, 0.9, 1, 1e-9}));
  return summary;
}

/// The table of scenes in the text of a study.
std::string table(const Summary& summary, const Job& job) {
  const std::string text = to_text(summary, job);
  const std::size_t first = text.find("scenes ");
  return text.substr(first, text.find("\nerror ", first) - first);
}

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

TEST_CASE("The text counts the designs of each status that occurs") {
  Summary summary = without_optimum(Status::non_finite);
  summary.tally.statuses[static_cast<std::size_t>(Status::released)] = 20;
  CHECK_THAT(to_text(summary, Job{}), contains("designs   21\n") && contains(" 20 released\n") &&
                                          contains(" 1 non_finite\n") && !contains("not_released"));
}

TEST_CASE("The text reports that no design is released") {
  CHECK_THAT(to_text(without_optimum(Status::non_finite), Job{}),
             contains("non_finite") && contains("optimum   none: nothing was released\n"));
}

TEST_CASE("If released designs are excluded, the text says by what") {
  const Summary summary = without_optimum(Status::released);
  Job job;
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a taut sling\n"));
  job.optimum.objective = to_expression(Field::range);
  job.optimum.constraints = {{to_expression(Field::apex), true, 3}};
  CHECK_THAT(to_text(summary, job),
             contains("optimum   none: no released design has a finite range and has a taut sling "
                      "and satisfies the constraints\n"));
}

TEST_CASE("The optimum's objective is printed with its unit, and so are the constraints") {
  const Summary summary = with_optimum(best_design({0.5, 0.58, 0.91}, 27.01));
  const std::string place = " at r1 = 0.5, r2 = 0.91, r3 = 0.58 m, released at 0.75 s";
  Job job;
  CHECK_THAT(to_text(summary, job), contains("optimum   15.50000000 m/s" + place + "\n"));
  job.optimum.objective = to_expression(Field::range);
  CHECK_THAT(to_text(summary, job),
             contains("optimum   range 27.01 m" + place + " with 15.50000000 m/s\n"));
  job.optimum.objective = to_expression(Field::efficiency);
  job.optimum.constraints = {{to_expression(Field::peak_axle_load), true, 150000},
                             {to_expression(Field::least_sling_tension), false, 0}};
  job.output.optimum_filter = OptimumFilter::taut;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   efficiency 27.01" + place +
                      " with 15.50000000 m/s, the sling taut, subject to peak-axle-load <= 150000, "
                      "least-sling-tension >= 0\n"));
}

TEST_CASE("The refined optimum has its error and takes the place of the lattice's when complete") {
  Job job;
  job.optimum.refine = true;
  Summary summary = with_optimum(best_design({0.512345678, 0.58, 0.91}, 16.5));
  CHECK_THAT(to_text(summary, job),
             contains("refined   15.50000000 m/s at r1 = 0.5123457, r2 = 0.9100000, r3 = 0.5800000 "
                      "m, released at 0.75 s, error 2e-09\n") &&
                 !contains("optimum   "));
  summary.complete = false;
  CHECK_THAT(to_text(summary, job),
             contains("optimum   15.50000000 m/s at r1 = 0.512345678") && !contains("refined   "));
}

TEST_CASE("The text gives the measured error") {
  Summary summary = without_optimum(Status::released);
  CHECK_THAT(to_text(summary, Job{}), contains("error     not measured\n"));
  summary.error = MeasuredError{8e-10, 1.5e-8, 4e-9, 128};
  CHECK_THAT(to_text(summary, Job{}),
             contains("error     8e-10 median, 1.5e-08 largest of 128 designs; 4e-09 at the "
                      "optimum\n"));
  summary.error->at_optimum = no_value;
  CHECK_THAT(to_text(summary, Job{}), contains("of 128 designs\n"));
  Job job;
  job.optimum.objective = to_expression(Field::range);
  CHECK_THAT(to_text(summary, job), contains("of 128 designs (of the speed, m/s)\n"));
}

TEST_CASE("The optimum of a study is that of its best scene, which is named") {
  Summary summary = summary_of(3);
  std::swap(summary.optima[0], summary.optima[2]);
  CHECK_THAT(to_text(summary, study_of(3)), contains("optimum   100.00000000 m/s") &&
                                                contains(", where projectile-mass = 3 kg\n"));
}

TEST_CASE("The table of scenes has units, and the largest value first") {
  Summary summary = summary_of(3);
  std::swap(summary.optima[0], summary.optima[2]);
  summary.optima[1].error = no_value;
  CHECK(table(summary, study_of(3)) == R"(scenes    3
          projectile-mass      speed   r1   r2   r3  error
                       kg        m/s    m    m    m    m/s
                        3        100  0.5  0.9  0.6  1e-09
                        2         50  0.5  0.9  0.6      -
                        1  33.333333  0.5  0.9  0.6  1e-09)");
}

TEST_CASE("Of more than 20 scenes, the table has the ten best and the worst") {
  CHECK(lines(table(summary_of(20), study_of(20))) == 22);
  const std::string text = table(summary_of(21), study_of(21));
  CHECK(lines(text) == 13);
  CHECK_THAT(text, contains("scenes    21; the 10 best, and the worst\n"));
  CHECK_THAT(text.substr(text.rfind('\n')), contains(" 21  4.7619048 "));
}

TEST_CASE("Scenes without an optimum are counted and not listed") {
  Summary summary = summary_of(3);
  summary.optima[1] = {};
  const std::string text = table(summary, study_of(3));
  CHECK_THAT(text, contains("scenes    3, 1 without an optimum\n"));
  CHECK(lines(text) == 4);
  summary.complete = false;
  CHECK_THAT(table(summary, study_of(3)),
             contains("scenes    3, 1 not done or without an optimum\n"));
  summary = summary_of(2);
  for (BestDesign& optimum : summary.optima) optimum = {};
  CHECK(table(summary, study_of(2)) == "scenes    2, 2 without an optimum");
}
