#include "trebsweep/optimum/coarse_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/optimum/design_problem.hpp"
#include "trebsweep/optimum/field_values.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::uint64_t most_designs = 300'000;  // of a coarse sweep

/// Computes values of designs on all ranks and reports the progress.
class RankedValues {
 public:
  RankedValues(const Job& job, std::size_t total, ProgressStyle style, MPI_Comm comm)
      : machine_(family_of(job)), comm_(comm), progress_(0, total, style) {}

  const MachineFamily& machine() const { return machine_; }

  /// The values of fields at parameters, a column for each. Collective.
  MatrixXd operator()(const MatrixXd& parameters, std::span<const Field> fields) {
    const auto ranks = static_cast<std::size_t>(mpi::size(comm_));
    const std::size_t rows = fields.size(), count = static_cast<std::size_t>(parameters.cols());
    // Small parts, since designs of one region may take longer than others.
    const std::size_t part = std::clamp<std::size_t>(count / (8 * ranks), 64, 2048);
    std::vector<double> all(rows * count);
    for (auto first = part * static_cast<std::size_t>(mpi::rank(comm_)); first < count;
         first += part * ranks) {
      const MatrixXd some = parameters.middleCols(
          static_cast<Index>(first), static_cast<Index>(std::min(part, count - first)));
      const MatrixXd values = field_values(machine_, Accuracy::coarse, some, fields);
      std::copy_n(values.data(), values.size(),
                  all.begin() + static_cast<std::ptrdiff_t>(rows * first));
      progress_.update(done_ + std::min(first + part * ranks, count));
    }
    mpi::merge(std::span(all), comm_);
    done_ += count;
    return Eigen::Map<const MatrixXd>(all.data(), static_cast<Index>(rows),
                                      static_cast<Index>(count));
  }

 private:
  MachineFamily machine_;
  MPI_Comm comm_;
  Progress progress_;
  std::size_t done_ = 0;
};

bool is_about_release_time(const Job& job) {
  return std::ranges::count(job.optimum.objective.fields, Field::release_time) +
             std::ranges::count(fields_of(job.optimum.constraints), Field::release_time) >
         0;
}

/// The violations of designs, each relative to the scale_of() the constraint; NaN without a
/// release.
std::vector<double> violations_of(const std::vector<Constraint>& constraints,
                                  const MatrixXd& parameters, RankedValues& values_of,
                                  std::vector<std::uint64_t>& violations) {
  const std::vector<Field> fields = fields_of(constraints);
  const MatrixXd values = values_of(parameters, fields);
  std::vector<double> worst(static_cast<std::size_t>(parameters.cols()));
  for_each_design(
      values_of.machine(), parameters, fields, values, [&](Index column, const Operands& operands) {
        double& largest = worst[static_cast<std::size_t>(column)];
        for (std::size_t c = 0; c < constraints.size(); ++c) {
          const double value = constraints[c].expression.value(operands);
          const double by =
              violation(constraints[c], value) / scale_of(constraints[c], operands.scene, 0);
          violations[c] += !(by <= feasibility_tolerance);
          largest = std::isnan(by) ? by : std::max(largest, by);
        }
      });
  return worst;
}

/// Sets the violations of designs, in descending order of their objectives, until some of them
/// satisfy the constraints: a design far below the best of these seldom leads to the optimum. Until
/// then, every third design below the best quarter is checked. Adds to `violations` how
/// many designs violate each constraint, and returns how many it checked. Collective.
std::uint64_t find_violations(const Job& job, const MatrixXd& parameters, RankedValues& values_of,
                              std::vector<Merit>& merit, std::vector<std::uint64_t>& violations) {
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < merit.size(); ++n)
    if (std::isfinite(merit[n].objective)) order.push_back(n);
  std::ranges::stable_sort(order, std::greater{},
                           [&](std::size_t n) { return merit[n].objective; });

  const std::vector<Constraint> constraints = constraints_of(job);
  const std::size_t part = std::max<std::size_t>(2048, order.size() / 16);
  std::size_t enough = order.size();
  bool found = false;
  std::uint64_t checked = 0;
  for (std::size_t first = 0; first < enough; first += part) {
    const std::size_t stride = found || first < order.size() / 4 ? 1 : 3;
    std::vector<std::size_t> some;
    for (std::size_t k = first; k < std::min(first + part, order.size()); k += stride)
      some.push_back(order[k]);
    checked += some.size();
    const auto worst =
        violations_of(constraints, parameters(Eigen::all, some), values_of, violations);
    for (std::size_t k = 0; k < some.size(); ++k) {
      merit[some[k]].violation = std::isnan(worst[k]) ? HUGE_VAL : worst[k];
      if (!is_feasible(merit[some[k]])) continue;
      enough = std::min(enough, 2 * (first + k * stride) + order.size() / 4);
      found = true;
    }
  }
  return checked;
}

}  // namespace

MatrixXd coarse_sample(const Job& job, std::size_t count) {
  if (!job.optimum.variables.empty()) return sobol_grid(job, count).parameters;
  const auto designs =
      sample(Lattice(job.scene, coarse_lattice(job.scene, job.lattice, most_designs)), count);
  MatrixXd parameters(length_count, std::ssize(designs));
  for (Index column = 0; const Design<double>& design : designs)
    parameters.col(column++) = to_parameters(design);
  return parameters;
}

CoarsePlan plan_coarse_sweep(const Job& job) {
  constexpr std::uint64_t sampled = 500, fewest = 4'000;
  // A second or two; more in a space of more dimensions, where searches take longer anyway.
  const double affordable_steps = job.optimum.variables.empty() ? 1e6 : 4e6;
  const MatrixXd parameters = coarse_sample(job, sampled);
  constexpr std::array fields{Field::steps, Field::release_time};
  MachineFamily machine = family_of(job);
  MatrixXd values = field_values(machine, Accuracy::coarse, parameters, fields);

  std::vector<double> times;
  for (const double time : values.row(1))
    if (std::isfinite(time)) times.push_back(time);
  if (!times.empty() && !is_about_release_time(job)) {
    constexpr double late = 3;
    const auto median = times.begin() + std::ssize(times) / 2;
    std::ranges::nth_element(times, median);
    machine.solver.max_time = std::min(machine.solver.max_time, late * *median);
    values = field_values(machine, Accuracy::coarse, parameters, fields);
  }
  double steps = 0;
  for (const double of_swing : values.row(0)) steps += std::isnan(of_swing) ? 0 : of_swing;
  const double affordable = affordable_steps * static_cast<double>(values.cols()) / (steps + 1);
  return {machine.solver.max_time, affordable > static_cast<double>(most_designs)
                                       ? most_designs
                                       : std::max(fewest, static_cast<std::uint64_t>(affordable))};
}

CoarseSweep coarse_sweep(const Job& job, const Grid& grid, ProgressStyle style, MPI_Comm comm) {
  const auto designs = static_cast<std::size_t>(grid.parameters.cols());
  const std::vector<Constraint> constraints = constraints_of(job);
  RankedValues values_of(job, designs * (constraints.empty() ? 1 : 2), style, comm);
  const Expression& objective = job.optimum.objective;
  const MatrixXd values = values_of(grid.parameters, objective.fields);
  std::vector<Merit> merit(designs);
  for_each_design(
      values_of.machine(), grid.parameters, objective.fields, values,
      [&](Index column, const Operands& operands) {
        const double value = objective.value(operands);
        merit[static_cast<std::size_t>(column)] = {value, std::isfinite(value) ? 0 : HUGE_VAL};
      });

  CoarseSweep sweep{.designs = designs,
                    .maxima = {},
                    .feasible = false,
                    .checked = 0,
                    .violations = std::vector<std::uint64_t>(constraints.size())};
  std::vector<std::size_t> maxima = local_maxima(grid, merit);
  if (maxima.empty()) return sweep;
  // If the best design satisfies the constraints, they need not be computed for the others, unless
  // starts that violate them are expensive because there are variables.
  const Parameters best = grid.parameters.col(static_cast<Index>(maxima.front()));
  sweep.feasible = constraints.empty() ||
                   violations_of(constraints, best, values_of, sweep.violations).front() <=
                       feasibility_tolerance;
  if (!sweep.feasible || (!job.optimum.variables.empty() && !constraints.empty())) {
    std::ranges::fill(sweep.violations, 0);
    for (Merit& m : merit) m.violation = HUGE_VAL;
    sweep.checked = find_violations(job, grid.parameters, values_of, merit, sweep.violations);
    maxima = local_maxima(grid, merit);
    sweep.feasible = !maxima.empty() && is_feasible(merit[maxima.front()]);
    if (sweep.feasible)
      std::erase_if(maxima, [&](std::size_t m) { return !is_feasible(merit[m]); });
  }
  for (const std::size_t m : maxima)
    sweep.maxima.emplace_back(grid.parameters.col(static_cast<Index>(m)));
  return sweep;
}

}  // namespace trebsweep
