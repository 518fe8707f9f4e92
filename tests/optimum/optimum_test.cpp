#include "trebsweep/optimum/optimum.hpp"

#include <fmt/format.h>

#include <random>
#include <string>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/reference.hpp"

#if __has_include(<gsl/gsl_multimin.h>)
#include <gsl/gsl_multimin.h>
#endif

using namespace trebsweep;

namespace {

OptimumResult optimum_of(const Job& job) {
  const auto result = find_optimum(job, {}, MPI_COMM_SELF);
  REQUIRE(result);
  return *result;
}

/// The largest value of a field, or -infinity.
double largest(const Job& job, Field field, std::span<const Design<double>> designs) {
  double best = -std::numeric_limits<double>::infinity();
  for (const double value : accurate_values(job, field, designs))
    if (value > best) best = value;
  return best;
}

/// The designs of a cube around a centre that lie in the job's design space.
std::vector<Design<double>> lattice_around(const Job& job, const Design<double>& centre,
                                           double spacing, int width) {
  const DesignSpace space = design_space(job);
  std::vector<Design<double>> inside = cube(centre, spacing, width);
  std::erase_if(inside, [&](const Design<double>& design) {
    const Parameters x = to_parameters(design);
    return (x.array() < space.lower.array()).any() || (x.array() > space.upper.array()).any() ||
           sum_excess(job, design) > 0;
  });
  return inside;
}

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// A scene of moderate size: an arm of a metre, all masses and effects at random.
Job random_job(std::mt19937_64& random, int kind) {
  Job job;
  Scene& scene = job.scene;
  scene.fulcrum_height = uniform(random, 0.6, 0.8);
  scene.counterweight_mass = uniform(random, 50, 2000);
  scene.projectile_mass = scene.counterweight_mass / uniform(random, 20, 150);
  scene.beam_density = uniform(random, 300, 1000);
  scene.beam_side = uniform(random, 0.02, 0.08);
  job.lattice.shortest_sling = 0.45 * scene.fulcrum_height;
  if (kind % 2 == 0) {
    scene.release_height = scene.fulcrum_height * uniform(random, 1.3, 1.6);
  } else {
    scene.start_angle = uniform(random, 0.6, 1.2);
    // Shorter arms swing to and fro, which takes long.
    if (kind % 16 != 1) job.lattice.r1 = AxisRange{0.1, 0.3, 0.01};
  }
  if (kind % 4 == 3) {
    scene.counterweight_hanger = uniform(random, 0.1, 0.2);
    job.lattice.shortest_sling = 0.7 * scene.fulcrum_height;
  }
  if (kind % 5 == 1) scene.pivot_viscosity = 10;
  const std::array releases{Release::crossing, Release::farthest, Release::pin, Release::fastest};
  // Longer than the throw; a counterweight that goes on swinging makes rough maps.
  job.solver.max_time = kind % 4 == 3 ? 1.0 : 1.5;
  job.solver.release = releases[static_cast<std::size_t>(kind / 2) % 4];
  if (job.solver.release == Release::pin) job.solver.pin_angle = uniform(random, 0.3, 0.8);
  if (job.solver.release == Release::crossing) job.solver.release_angle = uniform(random, 2.7, 3.4);
  const std::array objectives{Field::speed, Field::range, Field::efficiency};
  job.optimum.objective = to_expression(objectives[static_cast<std::size_t>(kind) % 3]);
  return job;
}

/// Every member of results that MPI ranks share, as text, without the run time.
std::string fingerprint(OptimumResult result) {
  std::string text =
      fmt::format("{:a} {:a} {:a} {:a} {:a} {:a} {}", result.value, result.error,
                  result.release_time, to_design(result.parameters).r1,
                  to_design(result.parameters).r3, to_design(result.parameters).r2, result.starts);
  for (const ActiveLimit& limit : result.active)
    text += fmt::format(" {} {:a}", limit.constraint, limit.multiplier);
  for (const double h : result.hessian.reshaped()) text += fmt::format(" {:a}", h);
  for (const auto& [key, s] : result.sensitivities)
    text += fmt::format(" {} {:a} {:a}", key, s.at_design, s.of_optimum);
  for (const LocalMaximum& m : result.maxima)
    text += fmt::format(" {:a} {:a} {}", m.value, to_design(m.parameters).r1, m.starts);
  if (result.robustness)
    text += fmt::format(" {:a} {:a}", result.robustness->worst, result.robustness->expected);
  return text;
}

}  // namespace

#if __has_include(<gsl/gsl_multimin.h>)
namespace {

const Job paper;

/// The design with r2 = h0 - r3 - s^2, which cannot be outside the bound (49).
Design<double> design_at(const gsl_vector* x) {
  const double r1 = gsl_vector_get(x, 0), r3 = gsl_vector_get(x, 1), s = gsl_vector_get(x, 2);
  return {r1, r3, paper.scene.fulcrum_height - r3 - s * s};
}

double minus_speed(const gsl_vector* x, void*) {
  const Design<double> design = design_at(x);
  const bool inside = design.r1 > 0.5 && design.r1 < 1.5 && design.r3 >= 0.3 && design.r2 > 0;
  const double speed =
      inside ? speed_in_extended_precision(paper.scene, design, 1e-15, paper.solver) : 0;
  return std::isnan(speed) ? 0 : -speed;
}

/// The end of Nelder and Mead's search, started again where it ends.
std::pair<Design<double>, double> nelder_mead() {
  gsl_multimin_function function{&minus_speed, 3, nullptr};
  gsl_vector *x = gsl_vector_alloc(3), *step = gsl_vector_alloc(3);
  gsl_vector_set(x, 0, 0.7), gsl_vector_set(x, 1, 0.7), gsl_vector_set(x, 2, 0.3);
  gsl_multimin_fminimizer* search =
      gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, 3);
  for (const double size : {0.1, 0.01, 1e-3, 1e-4}) {
    gsl_vector_set_all(step, size);
    gsl_multimin_fminimizer_set(search, &function, x, step);
    for (int i = 0; i < 500 && gsl_multimin_fminimizer_size(search) > 1e-10; ++i)
      if (gsl_multimin_fminimizer_iterate(search) != 0) break;
    gsl_vector_memcpy(x, gsl_multimin_fminimizer_x(search));
  }
  const std::pair found{design_at(x), -minus_speed(x, nullptr)};
  gsl_multimin_fminimizer_free(search);
  gsl_vector_free(x), gsl_vector_free(step);
  return found;
}

}  // namespace

TEST_CASE("The paper's optimum is that of Nelder and Mead's search in extended precision",
          "[alone]") {
  const auto [design, speed] = nelder_mead();
  const OptimumResult found = optimum_of(paper);
  CHECK(std::abs(to_design(found.parameters).r1 - design.r1) < 1e-6);
  CHECK(std::abs(to_design(found.parameters).r3 - design.r3) < 1e-6);
  CHECK(std::abs(to_design(found.parameters).r2 - design.r2) < 1e-6);
  CHECK(std::abs(found.value - speed) < 1e-9);
  CHECK(found.error < 1e-10);
  CHECK(to_design(found.parameters).r1 > 0.511);  // inside its bounds, as the paper's was not
  REQUIRE(found.active.size() == 1);
  CHECK(found.active[0].constraint == "r2 + r3 <= 1.5");
}
#endif

TEST_CASE("Value, release time, gradient and Hessian are those of extended precision", "[alone]") {
  const Job job = job_with({{"lattice.r1", "0.53:0.8:0.01"}});
  const OptimumResult found = optimum_of(job);
  const Parameters& x = found.parameters;
  const auto speed = [&](double d1, double d3, double d2) {
    return reference(job.scene, {x(0) + d1, x(1) + d3, x(2) + d2}, job.solver).speed;
  };
  const auto exact = reference(job.scene, to_design(found.parameters), job.solver);
  CHECK(std::abs(found.value - exact.speed) <= found.error);
  CHECK(found.error < 1e-11);
  CHECK(found.release_time == Approx(static_cast<double>(exact.release_time)).epsilon(1e-12));
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      std::array<double, 2> first{}, second{};  // with the step 2 h and h
      for (std::size_t k = 0; k < 2; ++k) {
        const double h = k == 0 ? 2e-3 : 1e-3;
        const auto at = [&](double a, double b) {
          std::array<double, 3> d{};
          d[i] += a * h;
          d[j] += b * h;
          return speed(d[0], d[1], d[2]);
        };
        first[k] = (at(1, 0) - at(-1, 0)) / (2 * h);
        second[k] = i == j ? (at(1, 0) - 2 * exact.speed + at(-1, 0)) / (h * h)
                           : (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h);
      }
      const double gradient = first[1] + (first[1] - first[0]) / 3;
      const double hessian = second[1] + (second[1] - second[0]) / 3;
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      if (i == j) CHECK(found.gradient(row) == Approx(gradient).epsilon(1e-6));
      CHECK(found.hessian(row, column) == Approx(hessian).epsilon(1e-4));
      CHECK(found.hessian(column, row) == Approx(found.hessian(row, column)).epsilon(1e-14));
    }
}

TEST_CASE("Limits that bind are satisfied, and no feasible design nearby is better", "[alone]") {
  std::mt19937_64 random(1);
  const std::array fields{Field::peak_sling_tension, Field::range, Field::efficiency,
                          Field::peak_axle_load, Field::peak_beam_stress};
  for (int kind = 0; kind < 5; ++kind) {
    Job job = random_job(random, 0);
    job.optimum.objective = to_expression(kind == 1 ? Field::efficiency : Field::speed);
    const OptimumResult unlimited = optimum_of(job);
    const Field field = fields[static_cast<std::size_t>(kind)];
    // The axle always bears the counterweight.
    const double part = field == Field::peak_axle_load ? 0.997 : uniform(random, 0.8, 0.95);
    const double limit = part * accurate_value(job, field, to_design(unlimited.parameters));
    job.optimum.constraints = {
        {.expression = to_expression(field), .is_upper = true, .limit = limit}};
    const OptimumResult found = optimum_of(job);
    INFO(kind << ", " << info(field).name);
    CHECK(found.value < unlimited.value);
    CHECK(accurate_value(job, field, to_design(found.parameters)) <= limit * (1 + 1e-9));
    CHECK(std::ranges::count(found.active, to_text(job.optimum.constraints[0]),
                             &ActiveLimit::constraint) == 1);
    const auto inside = lattice_around(job, to_design(found.parameters), 1e-3, 11);
    const auto bounded = accurate_values(job, field, inside);
    const auto values = accurate_objectives(job, inside);
    for (std::size_t i = 0; i < inside.size(); ++i)
      if (bounded[i] <= limit) CHECK_FALSE(values[i] > found.value * (1 + 1e-9));
  }
}

TEST_CASE("The optimum is never worse than the best of a sweep with a spacing of 5 mm", "[alone]") {
  std::mt19937_64 random(2);
  for (int kind = 0; kind < 20; ++kind) {
    Job job = random_job(random, kind);
    job.optimum.buildable = false;  // the sweep is of all designs
    const OptimumResult found = optimum_of(job);
    job.lattice.increment = 0.005;
    if (job.lattice.r1) job.lattice.r1->step = 0.005;
    const auto designs = all_designs(Lattice(job.scene, job.lattice));
    std::vector<SwingResult> swings(designs.size());
    std::vector<double> values(designs.size());
    integrate(job.scene, solver_of("vern8", 1e-7, job.solver),
              {designs, swings, job.optimum.objective.fields, values});
    std::size_t best = 0;
    for (std::size_t i = 0; i < designs.size(); ++i)
      if (has_speed(swings[i].status) && !(values[i] <= values[best])) best = i;
    INFO(kind << ": " << scene_text(job) << "; " << to_text(to_parameters(designs[best]), {})
              << "; found " << to_text(found.parameters, {}) << " from " << found.coarse_increment);
    const double value = accurate_objective(job, designs[best]);
    if (found.unsafe)
      CHECK(found.unsafe->value >= value - 1e-9 * std::abs(value));
    else
      CHECK(found.value >= value - 1e-9 * std::abs(value));
  }
}

TEST_CASE("Each of two nearly equal maxima is reported", "[alone]") {
  const Job job = job_with({{"scene.start-angle", "0.3"},
                            {"lattice.r1", "0.06"},
                            {"lattice.r3", "0.2:0.5:0.01"},
                            {"lattice.r2", "0.514:0.9:0.002"}});
  const OptimumResult found = optimum_of(job);
  REQUIRE(found.maxima.size() >= 2);
  const auto& [first, second] = std::pair(found.maxima[0], found.maxima[1]);
  CHECK(to_design(first.parameters) == to_design(found.parameters));
  CHECK(first.value >= second.value);
  CHECK(second.value > 0.99 * first.value);
  CHECK(std::abs(to_design(first.parameters).r3 - to_design(second.parameters).r3) > 0.2);
  for (const LocalMaximum& maximum : {first, second}) {
    CHECK(maximum.starts >= 1);
    const auto around = lattice_around(job, to_design(maximum.parameters), 2e-3, 5);
    CHECK(largest(job, Field::speed, around) <= maximum.value * (1 + 1e-9));
  }
}

TEST_CASE("The optimum is bitwise the same on any number of ranks") {
  const Job several = job_with({{"optimum.objective", "range"},
                                {"optimum.deviation", "0.003"},
                                {"optimum.subject-to", "peak-axle-load <= 1.6e5"}});
  const Job robust = job_with({{"optimum.deviation", "0.005"}, {"optimum.robust", "worst"}});
  // With two maxima, so that the ranks share the searches.
  const Job shared = job_with({{"scene.start-angle", "0.3"}, {"optimum.objective", "range"}});
  CHECK(optimum_of(shared).starts > 1);
  for (const Job& job : {several, robust, shared}) {
    const auto together = find_optimum(job, {}, MPI_COMM_WORLD);
    CHECK(together.has_value() == (mpi::rank(MPI_COMM_WORLD) == 0));
    if (together) CHECK(fingerprint(*together) == fingerprint(optimum_of(job)));
  }
}

TEST_CASE("A robust optimum is not worse in its worst case or its expectation than the plain one",
          "[alone]") {
  Job job = job_with({{"optimum.deviation", "0.005"}});
  const OptimumResult plain = optimum_of(job);
  job.optimum.robust = Robust::worst;
  const OptimumResult worst = optimum_of(job);
  job.optimum.robust = Robust::expected;
  const OptimumResult expected = optimum_of(job);
  CHECK(worst.robustness->worst > plain.robustness->worst);
  CHECK(worst.robustness->worst >= expected.robustness->worst);
  CHECK(expected.robustness->expected > plain.robustness->expected);
  CHECK(expected.robustness->expected >= worst.robustness->expected);
  CHECK(worst.value < plain.value);
}

TEST_CASE("Fixed lengths are kept, and without any other the design is the only one", "[alone]") {
  using Length = std::pair<const char*, double Design<double>::*>;
  const double best = optimum_of(Job{}).value;
  for (const auto& [axis, length] :
       {Length{"r1", &Design<double>::r1}, Length{"r3", &Design<double>::r3},
        Length{"r2", &Design<double>::r2}}) {
    const OptimumResult one = optimum_of(job_with({{std::string("lattice.") + axis, "0.6"}}));
    CHECK(to_design(one.parameters).*length == 0.6);
    CHECK(one.value < best);
  }
  const Job fixed =
      job_with({{"lattice.r1", "0.52"}, {"lattice.r3", "0.55"}, {"lattice.r2", "0.9"}});
  const OptimumResult all = optimum_of(fixed);
  CHECK(to_design(all.parameters) == Design<double>{0.52, 0.55, 0.9});
  CHECK(all.active.empty());
  CHECK(all.value ==
        Approx(accurate_value(fixed, Field::speed, to_design(all.parameters))).epsilon(1e-13));
}

TEST_CASE("Where there is no optimum, all ranks say why") {
  const auto message = [](const Overrides& options) {
    try {
      find_optimum(job_with(options), {}, MPI_COMM_WORLD);
    } catch (const NoOptimum& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  CHECK_THAT(message({{"scene.release-height", "3.5"}}), contains("the design space is empty: r1"));
  CHECK_THAT(message({{"solver.max-time", "0.2"}}), contains("nothing is released"));
  CHECK_THAT(message({{"optimum.subject-to", "peak-axle-load <= 1e4, speed >= 16"}}),
             contains("constraints exclude every design"));
  CHECK_THAT(message({{"optimum.deviation", "0.3"},
                      {"optimum.robust", "worst"},
                      {"lattice.r3", "0.6"},
                      {"lattice.r2", "0.9"}}),
             contains("optimum.deviation = 0.3"));
  // Refused without a search: no length is above 1.5 m.
  CHECK_THAT(message({{"optimum.deviation", "1.5"}, {"optimum.robust", "expected"}}),
             contains("optimum.deviation = 1.5"));
}

TEST_CASE("Refining the best of a lattice gives the optimum", "[alone]") {
  for (const std::string objective : {"speed", "range"}) {
    const Job job = job_with({{"optimum.objective", objective}});
    const OptimumResult optimum = optimum_of(job);
    const auto refined = refine(job, {0.52, 0.6, 0.88});
    REQUIRE(refined);
    const BestDesign& best = *refined;
    CHECK(best.value == Approx(optimum.value).epsilon(1e-12));
    CHECK(best.design.r1 == Approx(to_design(optimum.parameters).r1).epsilon(1e-7));
    CHECK(best.release_time == Approx(optimum.release_time).epsilon(1e-6));
    CHECK(best.speed == Approx(accurate_value(job, Field::speed, best.design)).epsilon(1e-12));
    CHECK(best.error < 1e-9);
  }
  CHECK_FALSE(refine(job_with({{"optimum.subject-to", "peak-axle-load <= 1e4, speed >= 16"}}),
                     {0.52, 0.6, 0.88}));
}
