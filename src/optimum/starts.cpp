#include "trebsweep/optimum/starts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "trebsweep/base/error.hpp"
#include "trebsweep/optimum/cma_es.hpp"
#include "trebsweep/optimum/coarse_grid.hpp"
#include "trebsweep/optimum/coarse_sweep.hpp"
#include "trebsweep/optimum/maxima.hpp"
#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {
namespace {

constexpr std::size_t max_starts = 16, max_edge_starts = 4;

/// Adds the best designs of a coarse sweep. Designs that violate the constraints are starts only as
/// long as there are no others.
void add_starts(const CoarseSweep& sweep, std::size_t count, Starts& starts) {
  starts.integrated += sweep.designs;
  starts.checked += sweep.checked;
  for (std::size_t i = 0; i < sweep.violations.size(); ++i)
    starts.violations[i] += sweep.violations[i];
  if (starts.feasible && !sweep.feasible) return;
  if (sweep.feasible && !starts.feasible) starts.parameters.clear();
  starts.feasible = sweep.feasible;
  const std::size_t most = sweep.feasible ? count : 2;
  for (std::size_t i = 0; i < std::min(most, sweep.maxima.size()); ++i)
    starts.parameters.push_back(sweep.maxima[i]);
}

}  // namespace

Starts find_starts(const Job& job, bool own_lattice, ProgressStyle style, MPI_Comm comm) {
  const CoarsePlan plan = plan_coarse_sweep(job);
  Job coarse = job;
  coarse.solver.max_time = plan.max_time;
  const bool has_variables = !job.optimum.variables.empty();
  if (!own_lattice && !has_variables)
    coarse.lattice = coarse_lattice(job.scene, job.lattice, plan.designs);
  const Grid grid =
      has_variables ? sobol_grid(job, plan.designs) : lattice_grid(job.scene, coarse.lattice);
  const CoarseSweep sweep = coarse_sweep(coarse, grid, style, comm);
  Starts starts;
  starts.increment = grid.increment;
  starts.spacing = grid.spacing;
  starts.max_time = plan.max_time;
  starts.violations.resize(sweep.violations.size());
  add_starts(sweep, max_starts, starts);
  if (has_variables && sweep.feasible && sweep.maxima.size() > max_starts)
    starts.others.assign(sweep.maxima.begin() + max_starts, sweep.maxima.end());
  // Swings next to r1 = 0 take long: too long to search for a first feasible design there.
  const bool has_edge =
      !has_variables && !own_lattice && (sweep.feasible || arm_bounds(job.scene).low > 0);
  if (const auto edge = edge_lattice(job.scene, coarse.lattice); edge && has_edge)
    add_starts(coarse_sweep(coarse, lattice_grid(job.scene, *edge), style, comm), max_edge_starts,
               starts);
  if (starts.parameters.empty())
    throw NoOptimum(fmt::format(
        "nothing is released: none of {} designs{} has a release{}", starts.integrated,
        starts.increment > 0 ? fmt::format(" with a spacing of {} m", starts.increment) : "",
        field_of(job.optimum.objective)
            ? ""
            : fmt::format(" and a finite {}", shown(job.optimum.objective).text)));
  return starts;
}

std::vector<Parameters> evolved(const DesignProblem& problem, const Starts& starts,
                                ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated) {
  constexpr double same = 0.02;  // scaled
  const Eigen::VectorXd spread = to_scaled(problem, starts.spacing / 4);
  DesignProblem coarse = problem;
  coarse.machine.solver.max_time = starts.max_time;
  const auto evolve_from = [&](const Parameters& start, std::uint64_t& count) {
    const NonlinearProgram program = nominal_program(coarse, count, Accuracy::coarse);
    return ProblemOptimum{evolve(program, to_scaled(problem, start), spread), false, {}};
  };
  std::vector<Parameters> all = starts.parameters;
  all.insert(all.end(), starts.others.begin(), starts.others.end());
  std::vector<Eigen::VectorXd> ends;
  for (const Found& found : find_maxima(all, evolve_from, style, comm, integrated)) {
    const Eigen::VectorXd x = Eigen::VectorXd::Map(found.x.data(), spread.size());
    const auto is_near = [&](const Eigen::VectorXd& end) { return (end - x).norm() < same; };
    if (ends.size() < max_starts && std::ranges::none_of(ends, is_near)) ends.push_back(x);
  }
  std::vector<Parameters> parameters;
  for (const Eigen::VectorXd& x : ends) parameters.push_back(to_parameters(problem, x));
  return parameters;
}

void refuse_constraints(const DesignProblem& problem, const Starts& starts) {
  const Parameters& closest = starts.parameters.front();
  const auto most = std::ranges::max_element(starts.violations);
  const Eigen::VectorXd values = quantities(problem, problem.machine, closest);
  std::vector<std::string> violated;
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    const Constraint& constraint = problem.constraints[i];
    const double value = values(static_cast<Eigen::Index>(i) + 1);
    if (!(violation(constraint, value) / problem.scales[i + 1] <= feasibility_tolerance))
      violated.push_back(fmt::format("{} ({:.9g})", to_text(constraint), value));
  }
  if (violated.empty() || starts.checked == 0)
    throw NoOptimum(fmt::format("no search from {} designs ends at one that is released{}{}",
                                starts.parameters.size() + starts.others.size(),
                                violated.empty() ? "" : " and satisfies ",
                                fmt::join(violated, " and ")));
  throw NoOptimum(fmt::format(
      "the constraints exclude every design found: {} excludes {} of {} checked; the closest is "
      "{}, which violates {}",
      to_text(problem.constraints[static_cast<std::size_t>(most - starts.violations.begin())]),
      *most, starts.checked, to_text(closest, problem.machine.variables),
      fmt::join(violated, " and ")));
}

}  // namespace trebsweep
