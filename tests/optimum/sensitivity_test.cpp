#include "trebsweep/optimum/sensitivity.hpp"

#include <fmt/format.h>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/swing/reference.hpp"

using namespace trebsweep;

namespace {

const Design<double> paper{0.51142299, 0.58339719, 0.91660281};  // its optimum

const Key& key_of(const std::string& name) {
  return *std::ranges::find(job_keys(), name, &Key::name);
}

Job with_key(Job job, const std::string& name, double value) {
  key_of(name).set(job, fmt::format("{}", value));
  return job;
}

double value_of(const Job& job, const std::string& name) {
  double value = 0;
  REQUIRE(parse_number(key_of(name).get(job), value));
  return value;
}

/// d f / d x at x by Richardson's extrapolation of differences with the steps h, h/2 and h/4:
/// central ones, or one-sided ones where x is 0.
template <class F>
double derivative(F f, double x, double h) {
  const double here = x == 0 ? f(0) : 0;
  const auto quotient = [&](double step) {
    return x == 0 ? (f(step) - here) / step : (f(x + step) - f(x - step)) / (2 * step);
  };
  const double a = quotient(h), b = quotient(h / 2), c = quotient(h / 4);
  const double factor = x == 0 ? 2 : 4;
  const double ab = b + (b - a) / (factor - 1), bc = c + (c - b) / (factor - 1);
  return bc + (bc - ab) / (factor * factor - 1);
}

/// A step of a key that is 0, which changes the speed by about a thousandth.
double step_from_zero(const std::string& name) {
  return name == "scene.pivot-friction" ? 10 : name == "scene.sling-angle" ? 0.005 : 1;
}

struct Optimum {
  DesignProblem problem;
  Design<double> design;
  double value;
  Eigen::VectorXd derivatives;  // with respect to limits(problem)
};

Optimum optimum_of(const Job& job, const Design<double>& start) {
  Optimum optimum{design_problem(job, to_parameters(start)), {}, 0, {}};
  std::uint64_t integrated = 0;
  const KktPoint found = search(nominal_program(optimum.problem, integrated),
                                to_scaled(optimum.problem, to_parameters(start)));
  REQUIRE(found.converged);
  REQUIRE(is_feasible(found.point));
  optimum.design = to_design(to_parameters(optimum.problem, found.point.x));
  optimum.value = found.point.objective * optimum.problem.scales[0];
  optimum.derivatives = found.multipliers;
  const std::vector<Limit> all = limits(optimum.problem);
  for (std::size_t i = 0; i < all.size(); ++i)
    optimum.derivatives(static_cast<Eigen::Index>(i)) *= all[i].factor;
  return optimum;
}

}  // namespace

TEST_CASE("Sensitivities of the paper's optimum are differences of extended precision") {
  const Job job;
  const DesignProblem problem = design_problem(job, to_parameters(paper));
  for (const std::string& name : numeric_scene_keys(job)) {
    INFO(name);
    const double value = value_of(job, name);
    const auto speed = [&](double v) {
      return reference(with_key(job, name, v).scene, paper, job.solver).speed;
    };
    const double step = value == 0 ? step_from_zero(name) : 1e-3 * value;
    const auto none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(limits(problem).size()));
    const Sensitivity found = sensitivity(job, name, to_parameters(paper), {{problem, 1, none}});
    CHECK(found.value == value);
    CHECK(found.at_design == Approx(derivative(speed, value, step)).epsilon(1e-6));
    CHECK(found.of_optimum == found.at_design);
  }
}

TEST_CASE("Sensitivities in other scenes are differences of extended precision") {
  const Job friction = job_from(R"([scene]
pivot-friction = 510
pivot-viscosity = 20
sling-mass = 5
sling-angle = -0.2)");
  const Job elastic = job_from(R"([scene]
sling-stiffness = 3e5
sling-damping = 500
start-angle = 0.9)");
  const Job siege = job_from(R"([scene]
counterweight-mass = 6000
projectile-mass = 60
counterweight-hanger = 1.5
fulcrum-height = 5.5
beam-mass = 1000
beam-centre = 2.5
beam-moment = 15000
start-angle = 0.9
trough = yes
[lattice]
r1 = 1.5:2.5:0.1
r3 = 7:8:0.1
r2 = 7.5:8.5:0.1
[solver]
release = pin
pin-angle = 0.5)");
  const std::vector<std::pair<Job, Design<double>>> machines{
      {friction, paper}, {elastic, {0.6, 0.6, 0.85}}, {siege, {2, 7.5, 8}}};
  for (const auto& machine : machines) {
    const Job& job = machine.first;
    const Design<double>& design = machine.second;
    const DesignProblem problem = design_problem(job, to_parameters(design));
    for (const std::string& name : numeric_scene_keys(job)) {
      const double value = value_of(job, name);
      if (value == 0) continue;
      INFO(name);
      const auto speed = [&](double v) {
        return speed_in_extended_precision(with_key(job, name, v).scene, design, 1e-16, job.solver);
      };
      const auto none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(limits(problem).size()));
      const double exact = derivative(speed, value, 2e-4 * std::abs(value));
      const double margin = 1e-9 * speed(value) / std::abs(value);
      CHECK(sensitivity(job, name, to_parameters(design), {{problem, 1, none}}).at_design ==
            Approx(exact).epsilon(1e-6).margin(margin));
    }
  }
}

TEST_CASE("The keys are the numeric ones in use, without effects that the scene lacks") {
  CHECK(numeric_scene_keys(Job{}) ==
        std::vector<std::string>{
            "scene.gravity", "scene.counterweight-mass", "scene.projectile-mass",
            "scene.release-height", "scene.fulcrum-height", "scene.beam-density", "scene.beam-side",
            "scene.sling-angle", "scene.pivot-viscosity", "scene.pivot-friction",
            "scene.sling-mass", "scene.counterweight-inertia"});
  const Job elastic = job_with({{"scene.sling-stiffness", "3e5"}, {"scene.start-angle", "0.9"}});
  const auto keys = numeric_scene_keys(elastic);
  for (const std::string name : {"sling-stiffness", "sling-damping", "start-angle"})
    CHECK(std::ranges::count(keys, "scene." + name) == 1);
  CHECK(std::ranges::count(keys, "scene.release-height") == 0);
  const auto drag = numeric_scene_keys(job_with({{"scene.projectile-diameter", "0.2"}}));
  for (const std::string name : {"projectile-diameter", "drag-coefficient", "air-density", "wind"})
    CHECK(std::ranges::count(drag, "scene." + name) == 1);
}

TEST_CASE("The sensitivity of the optimum is that of optima found in changed scenes") {
  const Job plain;  // limited by r2 + r3 <= h0
  const Job axle = job_with({{"optimum.subject-to", "peak-axle-load <= 1.6e5"}});
  const Job range = job_with({{"optimum.objective", "range"},
                              {"scene.projectile-diameter", "0.2"},
                              {"lattice.r1", "0.55:0.8:0.05"}});
  for (const Job& job : {plain, axle, range}) {
    const Optimum optimum = optimum_of(job, {0.56, 0.6, 0.85});
    for (const std::string& name : numeric_scene_keys(job)) {
      const double value = value_of(job, name);
      if (value == 0) continue;
      INFO(name);
      const auto best = [&](double v) {
        return optimum_of(with_key(job, name, v), optimum.design).value;
      };
      const double h = 2e-4 * value, exact = (best(value + h) - best(value - h)) / (2 * h);
      const Sensitivity found = sensitivity(job, name, to_parameters(optimum.design),
                                            {{optimum.problem, 1, optimum.derivatives}});
      CHECK(found.of_optimum == Approx(exact).epsilon(1e-3).margin(1e-5 * optimum.value / value));
    }
  }
}
