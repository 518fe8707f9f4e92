#include "trebsweep/cli/warnings.hpp"

#include <array>
#include <limits>

#include "support/catch.hpp"
#include "support/paper_solver.hpp"
#include "support/small_archive.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/scene_optima.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

constexpr BuildValues sound{1, 1, 1, 1, 1};

/// Integrates a job's whole lattice and returns its warnings.
std::vector<std::string> warnings_of(const Job& job) {
  const Study study(job);
  Totals totals(1);
  for (const auto& design : all_designs(study.lattice(0))) {
    SwingResult result;
    integrate(job.scene, job.solver, {{&design, 1}, {&result, 1}});
    const Index3 index = study.lattice(0).index_of(design);
    totals.tally.add(result, study.cell(0, index), design, result.speed);
  }
  totals.best[0] = totals.tally.best;
  totals.tally.sweep_seconds = 6000;  // the check may take a minute
  if (totals.best[0].exists()) totals.optima[0] = scene_optimum(job, totals.best[0], {});
  const auto samples = check_scenes(
                           study, totals, [] { return false; }, MPI_COMM_WORLD)
                           .value();
  SweepResult result{totals.summary(), samples};
  result.summary.error = measured_error(samples, 0);
  return warnings(study, result);
}

/// The optimum of a scene, with its value as its speed.
BestDesign optimum_at(const Design<double>& design, double value = 5,
                      const BuildValues& build = sound) {
  BestDesign optimum;
  optimum.value = optimum.speed = value;
  optimum.design = design;
  optimum.release_time = 1;
  optimum.build = build;
  return optimum;
}

/// The result of a sweep with the given optima of its scenes.
SweepResult result_of(const std::vector<BestDesign>& optima) {
  SweepResult result;
  result.summary.optima = optima;
  return result;
}

/// The warnings of a job with one scene.
std::vector<std::string> warnings_of(const Job& job, const BestDesign& optimum,
                                     const std::vector<Check>& checks = {},
                                     const std::optional<MeasuredError>& error = {}) {
  SweepResult result = result_of({optimum});
  result.summary.error = error;
  result.samples = {ErrorSample{0, checks, 0}};
  return warnings(Study(job), result);
}

/// The number of lines that contain the words.
std::ptrdiff_t count(const std::vector<std::string>& lines, const std::string& words) {
  return std::count_if(lines.begin(), lines.end(),
                       [&](const std::string& line) { return line.find(words) != line.npos; });
}

Job coarse_job() {
  Job job;
  job.lattice.increment = 0.1;
  return job;
}

/// The check of a released design with a taut sling, without an error.
Check check_of(const Design<double>& design, double speed, double efficiency) {
  const SwingResult result{speed, 1, 1, Status::released};
  return {design, result, result, efficiency, 1, no_value};
}

}  // namespace

TEST_CASE("The warning for the paper's optimum names both edges of the lattice that it lies on",
          "[alone]") {
  const auto lines = warnings_of(coarse_job());
  REQUIRE(lines.size() == 1);
  CHECK(lines[0] ==
        "the optimum lies on the edge of the lattice: r1 = 0.6 m, the smallest allowed by h - h0 < "
        "r1 (47); "
        "r2 = 0.9 m, the largest allowed by r2 < h0 - r3 (49)");
}

TEST_CASE("An axis with a single value has no edge to warn of", "[alone]") {
  Job job = coarse_job();
  job.lattice.r1 = AxisRange{0.51, 0.51, 1};
  job.lattice.r3 = AxisRange{0.58, 0.58, 1};
  job.lattice.r2 = AxisRange{0.8, 1.1, 0.1};
  CHECK(count(warnings_of(job), "edge") == 0);
}

TEST_CASE("A slack sling at the optimum is reported once, and not again of its neighbours",
          "[alone]") {
  Job job = coarse_job();
  job.scene.sling_angle = 1.5;
  job.lattice.r1 = AxisRange{0.6, 0.6, 1};
  const auto lines = warnings_of(job);
  CHECK(count(lines, "slack") == 1);
  CHECK(count(lines, "the optimum cannot be built: the sling goes slack") == 1);
}

TEST_CASE("A lattice without a release has no warnings", "[alone]") {
  Job job = coarse_job();
  job.scene.pivot_friction = 1e9;
  CHECK(warnings_of(job).empty());
}

TEST_CASE("A time step of 0.2 s is reported to change statuses", "[alone]") {
  Job job = coarse_job();
  job.solver = paper_solver();
  job.solver.time_step = 0.2;
  CHECK(count(warnings_of(job), "a different status when integrated accurately") == 1);
}

TEST_CASE("A time step that is too long for accurate speeds is reported", "[alone]") {
  Job job = coarse_job();
  job.solver.stepper = "euler";
  job.solver.time_step = 0.05;
  CHECK(count(warnings_of(job), "the fixed step is long") == 1);
}

TEST_CASE("Designs released at the start are not reported to create energy", "[alone]") {
  Job job = coarse_job();
  job.scene.release_height = 1.2;  // r1 = 0.3 starts at phi1 = pi
  CHECK(count(warnings_of(job), "efficiency") == 0);
}

TEST_CASE("A tolerance that is too loose for accurate speeds is reported", "[alone]") {
  Job job = coarse_job();
  job.scene.sling_stiffness = 1e7;
  job.scene.sling_damping = 1e4;
  job.solver.stepper = "fehlberg78";
  job.solver.tolerance = 0.1;
  CHECK(count(warnings_of(job), "the tolerance is loose") == 1);
}

TEST_CASE("The warning about an edge gives the bound of r1 with a hanger or a start angle",
          "[alone]") {
  const auto edge_of = [](const Job& job, std::size_t i1) {
    const Lattice lattice(job.scene, job.lattice);
    const auto lines = warnings_of(job, optimum_at(lattice.design({i1, 5, 1})));
    return lines.empty() ? "" : lines[0];
  };
  Job job = coarse_job();
  job.scene.counterweight_hanger = 0.25;
  CHECK_THAT(edge_of(job, 0), contains("the smallest allowed by h - h0 + r4 < r1 (47)"));
  job.scene.start_angle = 0.9;
  CHECK_THAT(edge_of(job, 0), contains("r1 = 0.1 m, the smallest allowed by 0 < r1 (47)"));
  CHECK_THAT(edge_of(job, 11), contains("r1 = 1.2 m, the largest allowed by r1 < h0 - r4 (47)"));
  CHECK(edge_of(job, 5) == "");
}

TEST_CASE("Without checks only the edges of the lattice are reported", "[alone]") {
  Job job = coarse_job();
  job.solver = paper_solver();
  job.solver.time_step = 0.2;
  const Lattice lattice(job.scene, job.lattice);
  CHECK(warnings_of(job, BestDesign{}).empty());
  CHECK(warnings_of(job, optimum_at(lattice.design({0, 0, 0}))).size() == 1);
}

TEST_CASE("Errors and efficiencies are judged by the largest speed, not that of the optimum",
          "[alone]") {
  const Job job = coarse_job();
  const Lattice lattice(job.scene, job.lattice);
  const Design<double> design = lattice.design({4, 5, 1});
  const Check fast = check_of(design, 17, 0.5), slow = check_of(design, 1e-3, 1.5);
  BestDesign optimum = optimum_at(design);
  optimum.speed = 1e-3;  // of an objective that is best in a slow design
  const MeasuredError small{0, 0.1, 0, 2}, large{0, 0.2, 0, 2};
  CHECK(warnings_of(job, optimum, {fast, slow}, small).empty());
  for (const BestDesign& best : {optimum, BestDesign{}})
    CHECK(count(warnings_of(job, best, {fast}, large), "the tolerance is loose") == 1);
  CHECK(count(warnings_of(job, BestDesign{}, {slow}, large), "efficiency above 1") == 1);
}

TEST_CASE("Slack slings are reported of designs close to the optimum in its objective", "[alone]") {
  Job job = coarse_job();
  job.optimum.objective = to_expression(Field::sling_angle);
  const Lattice lattice(job.scene, job.lattice);
  const Design<double> design = lattice.design({4, 5, 1});
  BestDesign optimum = optimum_at(design, -2);
  optimum.speed = 10;
  const auto report = [&](double objective) {
    Check slack = check_of(design, 10, 0.5);
    slack.slack = 2;
    slack.objective = objective;
    return warnings_of(job, optimum, {slack});
  };
  REQUIRE(report(-2.09).size() == 1);
  CHECK_THAT(report(-2.09)[0], contains("in 1 of 1 designs checked within 5 % of the optimum's "
                                        "sling-angle, where"));
  CHECK(report(-2.11).empty());
  CHECK(report(no_value).empty());  // it violates a constraint
}

TEST_CASE("An optimum that cannot be built is reported first, with each body and amount",
          "[alone]") {
  Job job = coarse_job();
  job.lattice.r1 = AxisRange{0.6, 1, 0.1};
  const auto with = [&](const BuildValues& build) {
    return warnings_of(job, optimum_at(Study(job).lattice(0).design({0, 5, 1}), 5, build));
  };
  const auto lines = with({-30, -200, -0.152, 0.1, -2e-6});
  REQUIRE(lines.size() == 2);
  CHECK(lines[0] ==
        "the optimum cannot be built: the arm's tip reaches 0.15 m below the ground; the "
        "projectile reaches 2e-06 m below the ground; the sling goes slack: to stay straight, it "
        "would have to push with 30 N; the counterweight's hanger is under a compression of 200 N");
  CHECK_THAT(lines[1], contains("the smallest allowed by lattice.r1"));
  CHECK(with({0, 0, -1e-7, 0, 0}).size() == 1);
  CHECK(with({no_value, no_value, no_value, no_value, no_value}).size() == 1);
}

TEST_CASE("A refined optimum lies on the edge only where it reaches what the job sets", "[alone]") {
  Job job = coarse_job();
  job.optimum.refine = true;
  job.lattice.r1 = AxisRange{0.55, 0.85, 0.1};
  const auto lines_at = [&](const Design<double>& design) {
    return warnings_of(job, optimum_at(design));
  };
  CHECK(lines_at({0.6, 0.5, 1}).empty());  // on the bound r2 + r3 = h0 (49)
  CHECK(lines_at({0.8499, 0.5, 1}).empty());
  REQUIRE(lines_at({0.85 - 1e-12, 0.5, 1}).size() == 1);
  CHECK(lines_at({0.85 - 1e-12, 0.5, 1})[0] ==
        "the optimum lies on the edge of the lattice: r1 = 0.85 m, the largest allowed by "
        "lattice.r1");
  REQUIRE(lines_at({0.55, 0.3, 1}).size() == 1);
  CHECK_THAT(lines_at({0.55, 0.3, 1})[0],
             contains("r1 = 0.55 m, the smallest allowed by lattice.r1; r3 = 0.3 m, the smallest "
                      "allowed by lattice.shortest-sling"));
  job.lattice.r1 = AxisRange{0.55, 0.55, 1};
  job.lattice.r3 = AxisRange{0.5, 0.5, 1};
  CHECK(lines_at({0.55, 0.5, 1}).empty());
}

namespace {

/// A coarse job with projectiles of 50, 100 and 150 kg.
Job three_projectiles() {
  Job job = coarse_job();
  job.outer_axes = {{"scene.projectile-mass", {50, 100, 150}, "50, 100, 150"}};
  return job;
}

}  // namespace

TEST_CASE("The warnings of a study name the scene, and count those on the edge of the lattice",
          "[alone]") {
  const Job job = three_projectiles();
  const Study study(job);
  const auto best_at = [&](const Index3& index, double value) {
    return optimum_at(study.lattice(0).design(index), value);
  };
  SweepResult result =
      result_of({best_at({0, 5, 1}, 3), best_at({4, 5, 1}, 2), best_at({4, 0, 1}, 1)});
  const Check impossible = check_of(result.summary.optima[0].design, 3, 1.5);
  result.samples = {ErrorSample{0, {}, 0}, ErrorSample{2, {impossible}, 0}};
  const auto lines = warnings(study, result);
  REQUIRE(lines.size() == 3);
  CHECK_THAT(lines[0], contains("the best scene, projectile-mass = 50 kg: the optimum lies on the "
                                "edge of the lattice: r1 = 0.6 m"));
  CHECK_THAT(lines[1], contains("1 of 1 other scenes checked have warnings, such as that with "
                                "projectile-mass = 150 kg: an energy efficiency above 1"));
  CHECK(lines[2] ==
        "the optimum of 2 of 3 scenes lies on the edge of the lattice: the smallest r1 in 1, the "
        "smallest r3 in 1");
}

TEST_CASE("A study counts the scenes whose optimum cannot be built, in one line with an example",
          "[alone]") {
  const Job job = three_projectiles();
  const Study study(job);
  const Design<double> design = study.lattice(0).design({4, 5, 1});
  SweepResult result =
      result_of({optimum_at(design, 3), optimum_at(design, 2, {1, -5, -0.3, -0.2, 0}),
                 optimum_at(design, 1, {-50, 0, 0, -0.1, 0})});
  auto lines = warnings(study, result);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0] ==
        "the optimum of 2 of 3 scenes cannot be built: below the ground in 2, a slack sling in 1, "
        "a compressed hanger in 1, such as that with projectile-mass = 100 kg: the arm's tip "
        "reaches 0.3 m below the ground; the counterweight reaches 0.2 m below the ground; the "
        "counterweight's hanger is under a compression of 5 N");
  result.summary.optima[2].value = 4;
  lines = warnings(study, result);
  REQUIRE(lines.size() == 1);
  CHECK_THAT(lines[0], contains("such as the best one, with projectile-mass = 150 kg: the "
                                "counterweight reaches 0.1 m below the ground; the sling goes "
                                "slack: to stay straight, it would have to push with 50 N"));
  result.summary.optima[1] = result.summary.optima[2] = {};  // scenes without an optimum
  CHECK(warnings(study, result).empty());
}

TEST_CASE("A study counts the scenes whose refined optimum reaches the range that the job gives",
          "[alone]") {
  Job job = three_projectiles();
  job.optimum.refine = true;
  job.lattice.r1 = AxisRange{0.6, 0.8, 0.1};
  const Study study(job);
  const auto lines =
      warnings(study, result_of({optimum_at({0.8, 0.5, 1}), optimum_at({0.7999, 0.5, 1}, 6),
                                 optimum_at({0.6, 0.5, 1})}));
  REQUIRE(lines.size() == 1);
  CHECK(lines[0] ==
        "the optimum of 2 of 3 scenes lies on the edge of the lattice: the smallest r1 in 1, the "
        "largest r1 in 1");
}
