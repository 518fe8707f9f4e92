#include "trebsweep/optimum/search_cost.hpp"

#include <cmath>
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

/// The parameters with the largest objective; nothing if nothing is released.
std::optional<Parameters> best_of(const Job& job, const MachineFamily& machine,
                                  const Eigen::MatrixXd& parameters,
                                  const Eigen::MatrixXd& values) {
  std::optional<Parameters> best;
  double largest = -HUGE_VAL;
  for_each_design(machine, parameters, job.optimum.objective.fields, values,
                  [&](Eigen::Index column, const Operands& operands) {
                    const double value = job.optimum.objective.value(operands);
                    if (!(value > largest)) return;
                    largest = value;
                    best = parameters.col(column);
                  });
  return best;
}

}  // namespace

SearchCost search_cost(const Job& given_job, bool own_lattice) {
  constexpr std::size_t sampled = 2000;
  constexpr double searches = 4;  // most starts are given up early; what follows takes its time too
  Job job = searched_job(given_job);
  const CoarsePlan plan = plan_coarse_sweep(job);
  SearchCost cost{coarse_designs(job, own_lattice, plan.designs), 0, 0};
  MachineFamily machine = family_of(job);
  machine.solver.max_time = plan.max_time;
  const Eigen::MatrixXd parameters = coarse_sample(job, sampled);
  Eigen::MatrixXd values;
  const double seconds = processor_seconds([&] {
    values = field_values(machine, Accuracy::coarse, parameters, job.optimum.objective.fields);
    if (const auto constrained = fields_of(job.optimum.constraints); !constrained.empty())
      field_values(machine, Accuracy::coarse, parameters, constrained);
  });
  cost.coarse_seconds =
      seconds / static_cast<double>(parameters.cols()) * static_cast<double>(cost.designs);
  if (const auto start = best_of(job, machine, parameters, values))
    cost.search_seconds =
        searches * processor_seconds([&] {
          std::uint64_t integrated = 0;
          search(design_problem(job, *start), *start, Effort::thorough, integrated);
        });
  return cost;
}

}  // namespace trebsweep
