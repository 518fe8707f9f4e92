#include "trebsweep/optimum/starts.hpp"

#include <fmt/format.h>
#include <nlopt.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "optimum/jobs.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/optimum/optimum.hpp"

using namespace trebsweep;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

using Random = std::mt19937_64;

double between(Random& random, double low, double high) {
  return std::uniform_real_distribution(low, high)(random);
}

bool is_true(Random& random) { return random() % 2 == 0; }

/// A machine with two to five variables, a tie of lengths, and an objective that is a field or a
/// formula; every third hangs its counterweight on a hinge and starts in a trough.
std::string machine(int number) {
  Random random(static_cast<std::uint64_t>(number) + 2026);
  const bool is_hinged = number % 3 == 2;
  const double height = between(random, 0.8, 4), mass = between(random, 30, 2000);
  const double shot = mass / between(random, 30, 120), range = 12 * height;
  std::string text = fmt::format(
      "[scene]\nfulcrum-height = {}\ncounterweight-mass = {}\nprojectile-mass = {}\n"
      "beam-density = 600\nbeam-side = {}\nbeam-inertia = prism\nstart-angle = {}\n",
      height, mass, shot, between(random, 0.03, 0.06) * height, between(random, 0.4, 1));
  if (is_hinged) text += fmt::format("trough = yes\ncounterweight-hanger = {}\n", 0.3 * height);
  std::vector<std::string> variables{
      fmt::format("start-angle 0.3:1.2"),
      fmt::format("counterweight-mass {}:{}", 0.6 * mass, 1.2 * mass),
      fmt::format("projectile-mass {}:{}", 0.6 * shot, 1.5 * shot),
      fmt::format("fulcrum-height {}:{}", 0.8 * height, 1.1 * height),
      fmt::format("beam-side {}:{}", 0.03 * height, 0.08 * height)};
  if (is_hinged)
    variables.insert(variables.begin(),
                     fmt::format("counterweight-hanger {}:{}", 0.1 * height, 0.6 * height));
  else
    variables.push_back("sling-angle -0.5:0.5");
  std::shuffle(variables.begin() + (is_hinged ? 1 : 0), variables.end(), random);
  variables.resize(2 + random() % (is_hinged ? 2 : 4));
  text += fmt::format("[solver]\nrelease = {}\n[optimum]\nvariables = {}\n",
                      is_hinged         ? "farthest"
                      : is_true(random) ? "fastest"
                                        : "crossing",
                      fmt::join(variables, ", "));
  const std::string tie = is_true(random) ? fmt::format("r1 + r2 <= {}", 1.6 * height)
                                          : fmt::format("r2 / r1 <= {}", between(random, 2, 4));
  switch (number % 4) {
    case 0:
      return text + fmt::format("objective = range\nsubject-to = {}\n", tie);
    case 1:
      return text + fmt::format("objective = range - {}*peak-axle-load\nsubject-to = {}\n",
                                0.1 * height / mass, tie);
    case 2:
      return text + fmt::format(
                        "objective = speed\nsubject-to = {}, peak-axle-load / "
                        "counterweight-mass <= {}\n",
                        tie, between(random, 30, 60));
    default:
      return text + fmt::format("minimize = peak-axle-load\nsubject-to = {}, range >= {}\n", tie,
                                0.3 * range);
  }
}

/// Scaled parameters with their objective, or -infinity where a constraint is violated.
struct Candidate {
  VectorXd x;
  double objective;
};

bool are_inside(const DesignProblem& problem, const Parameters& parameters) {
  const Scene scene = at(problem.machine, parameters).scene;
  return std::ranges::all_of(problem.space.limits, [&](const SpaceLimit& limit) {
    return limit.excess(scene, to_design(parameters)) <= 0;
  });
}

/// The feasible ones of random parameters: `enough` of them, or those of `most` scenes with 24
/// designs each. Integrated at a tolerance of 1e-6, which orders them.
std::vector<Candidate> random_search(const DesignProblem& problem, const NonlinearProgram& program,
                                     std::size_t enough, int most, Random& random) {
  std::vector<Candidate> found;
  const auto any = [&](Index d) { return between(random, program.lower(d), program.upper(d)); };
  for (int scene = 0; scene < most && found.size() < enough; ++scene) {
    MatrixXd points(program.variables(), 24);
    for (Index d = program.cheap_variables; d < points.rows(); ++d)
      points.row(d).setConstant(any(d));
    for (Index d = 0; d < program.cheap_variables; ++d)
      for (double& x : points.row(d)) x = any(d);
    MatrixXd parameters(problem.space.size(), points.cols());
    for (Index p = 0; p < points.cols(); ++p)
      parameters.col(p) = to_parameters(problem, points.col(p));
    const MatrixXd values = values_at(problem, parameters, Accuracy::coarse);
    for (Index p = 0; p < points.cols(); ++p)
      if (values.col(p).allFinite() && values.col(p).tail(values.rows() - 1).maxCoeff() <= 0 &&
          are_inside(problem, parameters.col(p)))
        found.push_back({points.col(p), values(0, p)});
  }
  std::ranges::sort(found, std::greater{}, &Candidate::objective);
  return found;
}

/// The best feasible objective that NLopt's COBYLA finds from a point.
double refined(const NonlinearProgram& program, const VectorXd& start) {
  struct Search {
    const NonlinearProgram& program;
    VectorXd x, values;  // where the functions were computed last
    double best;

    const VectorXd& at(const double* point) {
      const VectorXd asked = VectorXd::Map(point, x.size());
      if (values.size() == 0 || asked != x) {
        x = asked;
        values = program.functions(x).col(0);
        const Point found = point_of(program, x, values);
        if (is_feasible(found)) best = std::max(best, found.objective);
        values = values.unaryExpr([](double v) { return std::isfinite(v) ? v : 1e3; });
      }
      return values;
    }
  };
  Search search{program, start, {}, -HUGE_VAL};
  const auto n = static_cast<unsigned>(start.size());
  const nlopt_opt optimizer = nlopt_create(NLOPT_LN_COBYLA, n);
  const auto objective = [](unsigned, const double* x, double*, void* data) {
    return static_cast<Search*>(data)->at(x)(0);
  };
  const auto constraints = [](unsigned m, double* result, unsigned, const double* x, double*,
                              void* data) {
    VectorXd::Map(result, m) = static_cast<Search*>(data)->at(x).tail(m);
  };
  nlopt_set_max_objective(optimizer, objective, &search);
  nlopt_add_inequality_mconstraint(optimizer, static_cast<unsigned>(program.constraints),
                                   constraints, &search, nullptr);
  nlopt_set_lower_bounds(optimizer, program.lower.data());
  nlopt_set_upper_bounds(optimizer, program.upper.data());
  nlopt_set_initial_step1(optimizer, 0.02);
  nlopt_set_xtol_rel(optimizer, 1e-8);
  nlopt_set_maxeval(optimizer, 500);
  VectorXd x = start;
  double value = 0;
  nlopt_optimize(optimizer, x.data(), &value);
  nlopt_destroy(optimizer);
  return search.best;
}

/// The optimum of a problem near the one that was found.
double optimum_near(const DesignProblem& problem, const Parameters& parameters) {
  std::uint64_t integrated = 0;
  const ProblemOptimum found = search(problem, parameters, Effort::thorough, integrated);
  CHECK(found.converged);
  return found.point.objective * problem.scales[0];
}

/// Checks the multipliers and some sensitivities of an optimum against those of changed problems.
void check_derivatives(const Job& job, const OptimumResult& found) {
  const DesignProblem problem = design_problem(searched_job(job), found.parameters);
  for (const ActiveLimit& active : found.active) {
    const auto optimum_with = [&](double change) {
      DesignProblem changed = problem;
      for (Constraint& c : changed.constraints)
        if (to_text(c) == active.constraint) c.limit += change;
      for (const Index d : problem.free) {
        const auto text = [&](const char* sign, double bound) {
          return fmt::format("{} {} {:.9g}", problem.space.names[static_cast<std::size_t>(d)], sign,
                             bound);
        };
        if (text(">=", problem.space.lower(d)) == active.constraint)
          changed.space.lower(d) += change;
        if (text("<=", problem.space.upper(d)) == active.constraint)
          changed.space.upper(d) += change;
      }
      for (SpaceLimit& limit : changed.space.limits)
        if (limit.text == active.constraint)
          limit.excess = [=, f = limit.excess](const Scene& scene, const Design<double>& design) {
            return f(scene, design) - change;
          };
      return optimum_near(changed, found.parameters);
    };
    const double h = 1e-5 * std::max(std::abs(found.value / active.multiplier), 1e-3);
    INFO(active.constraint);
    CHECK((optimum_with(h) - optimum_with(-h)) / (2 * h) ==
          Approx(active.multiplier).epsilon(1e-3).margin(1e-6 * std::abs(found.value)));
  }
  for (const auto& [key, s] : found.sensitivities) {
    if (key != "beam-density" && key != "gravity") continue;
    const auto optimum_with = [&, name = key, value = s.value](double factor) {
      Job varied = job;
      const auto& scene_key = *std::ranges::find(job_keys(), "scene." + name, &Key::name);
      scene_key.set(varied, fmt::format("{}", value * factor));
      return optimum_near(design_problem(searched_job(varied), found.parameters), found.parameters);
    };
    constexpr double h = 1e-5;
    INFO(key);
    CHECK((optimum_with(1 + h) - optimum_with(1 - h)) / (2 * h * s.value) ==
          Approx(s.of_optimum).epsilon(1e-3).margin(1e-6 * std::abs(found.value / s.value)));
  }
}

/// The numbers of the machines to check: of one that takes seconds, or those that
/// TREBSWEEP_MACHINES lists ("0,1,2"), each on one of the ranks.
std::vector<int> machine_numbers() {
  constexpr int quick = 9;
  const int rank = mpi::rank(MPI_COMM_WORLD), ranks = mpi::size(MPI_COMM_WORLD);
  const char* const given = std::getenv("TREBSWEEP_MACHINES");
  if (!given) return ranks == 1 ? std::vector{quick} : std::vector<int>{};
  std::vector<int> numbers;
  std::istringstream list(given);
  int place = 0;
  for (std::string number; std::getline(list, number, ',');)
    if (place++ % ranks == rank) numbers.push_back(std::stoi(number));
  return numbers;
}

}  // namespace

TEST_CASE("No random search finds a better machine, and derivatives are those of new searches") {
  const std::vector<int> numbers = machine_numbers();
  const bool is_long = std::getenv("TREBSWEEP_MACHINES") != nullptr;
  const std::size_t enough = is_long ? 20'000 : 500, searches = is_long ? 10 : 3;
  const int most = is_long ? 500'000 : 500;  // scenes
  for (const int number : numbers) {
    const std::string text = machine(number);
    INFO(text);
    const Job job = job_from(text);
    const auto found = find_optimum(job, {}, MPI_COMM_SELF);
    REQUIRE(found);
    std::uint64_t integrated = 0;
    const DesignProblem problem = design_problem(searched_job(job), found->parameters);
    const NonlinearProgram program = nominal_program(problem, integrated);
    Random random(static_cast<std::uint64_t>(number));
    const auto candidates = random_search(problem, program, enough, most, random);
    CHECK_FALSE(candidates.empty());
    double best = -HUGE_VAL;
    for (std::size_t i = 0; i < std::min(searches, candidates.size()); ++i)
      best = std::max(best, refined(program, candidates[i].x));
    // An optimum that is not safe to build may be better.
    const double ours = std::max(found->value, found->unsafe ? found->unsafe->value : -HUGE_VAL);
    CHECK(best * problem.scales[0] <= ours + 1e-6 * std::abs(ours));
    if (is_long)
      fmt::print(stderr, "machine {}: {} feasible; {:.9g}, random search {:.9g}; {:.1f} s{}\n",
                 number, candidates.size(), ours, best * problem.scales[0], found->seconds,
                 found->converged ? "" : ", not converged");
    if (found->converged) check_derivatives(job, *found);
  }
}

TEST_CASE("Evolution ends at better designs that differ, the same on any number of ranks") {
  const Job job = searched_job(job_with({{"optimum.variables", "fulcrum-height 1.2:1.8"},
                                         {"optimum.subject-to", "peak-axle-load <= 1.6e5"}}));
  Starts starts;
  starts.parameters = {Eigen::Vector4d(0.6, 0.5, 0.8, 1.5), Eigen::Vector4d(0.62, 0.45, 0.7, 1.3)};
  starts.others = {Eigen::Vector4d(0.7, 0.4, 0.6, 1.6)};
  starts.spacing = Parameters::Constant(4, 0.1);
  starts.max_time = job.solver.max_time;
  const DesignProblem problem = design_problem(job, starts.parameters.front());
  std::uint64_t integrated = 0, alone = 0;
  const auto ends = evolved(problem, starts, ProgressStyle::none, MPI_COMM_WORLD, integrated);
  CHECK(ends == evolved(problem, starts, ProgressStyle::none, MPI_COMM_SELF, alone));
  CHECK(integrated == alone);
  REQUIRE_FALSE(ends.empty());
  const double first = values_at(problem, starts.parameters.front(), Accuracy::coarse)(0);
  for (const Parameters& end : ends) {
    const VectorXd values = values_at(problem, end, Accuracy::coarse);
    CHECK(values.tail(values.size() - 1).maxCoeff() <= feasibility_tolerance);
    CHECK(are_inside(problem, end));
    for (const Parameters& other : ends)
      CHECK((other == end || (to_scaled(problem, other) - to_scaled(problem, end)).norm() >= 0.02));
  }
  CHECK(values_at(problem, ends.front(), Accuracy::coarse)(0) > 1.01 * first);
}
