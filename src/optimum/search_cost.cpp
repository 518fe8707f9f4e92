#include "trebsweep/optimum/search_cost.hpp"

#include <algorithm>
#include <ctime>
#include <optional>

#include "trebsweep/optimum/coarse_grid.hpp"
#include "trebsweep/optimum/coarse_sweep.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/optimum/maxima.hpp"

namespace trebsweep {
namespace {

/// The processor time that a function takes, s.
template <class F>
double processor_seconds(F f) {
  const std::clock_t start = std::clock();
  f();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::uint64_t coarse_designs(const Job& job, bool own_lattice, std::uint64_t planned) {
  if (!job.optimum.variables.empty()) return planned;
  return checked_lattice(
             job.scene, own_lattice ? job.lattice : coarse_lattice(job.scene, job.lattice, planned))
      .designs();
}

/// The best of some parameters; nothing if none has values.
std::optional<Parameters> best_of(const DesignProblem& problem, const Eigen::MatrixXd& parameters) {
  const Eigen::MatrixXd values = values_at(problem, parameters, Accuracy::coarse);
  std::optional<Parameters> best;
  Merit of_best{};
  for (Eigen::Index i = 0; i < parameters.cols(); ++i) {
    if (!values.col(i).allFinite()) continue;
    Merit merit{values(0, i), 0};
    for (const double violation : values.col(i).tail(values.rows() - 1))
      merit.violation = std::max(merit.violation, violation);
    if (best && !is_better(merit, of_best)) continue;
    best = parameters.col(i);
    of_best = merit;
  }
  return best;
}

}  // namespace

SearchCost search_cost(const Job& given_job, bool own_lattice) {
  constexpr std::size_t sampled = 2000;
  // Without variables, most starts are given up early; what follows takes its time too.
  const bool has_variables = !given_job.optimum.variables.empty();
  const double searches = has_variables ? 16 : 4;
  const Effort effort = has_variables ? Effort::quick : Effort::thorough;
  Job job = searched_job(given_job);
  const CoarsePlan plan = plan_coarse_sweep(job);
  SearchCost cost{coarse_designs(job, own_lattice, plan.designs), 0, 0};
  MachineFamily machine = family_of(job);
  machine.solver.max_time = plan.max_time;
  const Eigen::MatrixXd parameters = coarse_sample(job, sampled);
  const double seconds = processor_seconds([&] {
    field_values(machine, Accuracy::coarse, parameters, job.optimum.objective.fields);
    if (const auto constrained = fields_of(job.optimum.constraints); !constrained.empty())
      field_values(machine, Accuracy::coarse, parameters, constrained);
  });
  cost.coarse_seconds =
      seconds / static_cast<double>(parameters.cols()) * static_cast<double>(cost.designs);
  DesignProblem problem = design_problem(job, parameters.col(0));
  problem.machine = machine;
  if (!has_variables) problem.constraints.clear();  // starts may violate them
  if (const auto start = best_of(problem, parameters))
    cost.search_seconds = searches * processor_seconds([&] {
                            std::uint64_t integrated = 0;
                            search(design_problem(job, *start), *start, effort, integrated);
                          });
  return cost;
}

}  // namespace trebsweep
