#include "trebsweep/optimum/optimum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/optimum/allowance.hpp"
#include "trebsweep/optimum/coarse_sweep.hpp"
#include "trebsweep/optimum/derivatives.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t max_starts = 16, max_edge_starts = 4;

/// The best local maxima of a coarse sweep.
std::vector<Design<double>> best_of(const CoarseSweep& sweep, std::size_t count) {
  return {sweep.maxima.begin(),
          sweep.maxima.begin() + static_cast<std::ptrdiff_t>(std::min(sweep.maxima.size(), count))};
}

/// The end of a search, with up to three variables.
struct Found {
  std::array<double, 3> x;
  double objective, violation;
  bool converged;
  std::uint64_t integrated;
};

/// The ends of searches from designs, each by one of the ranks. Collective.
template <class Search>
std::vector<Found> search_from(const std::vector<Design<double>>& starts, ProgressStyle style,
                               MPI_Comm comm, Search search) {
  Progress progress(0, starts.size(), style, "searches");
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  return mpi::share(starts.size(), comm, [&](std::size_t i) {
    Found found{};
    const auto [point, multipliers, converged] = search(starts[i], found.integrated);
    std::ranges::copy(point.x, found.x.begin());
    found.objective = point.objective;
    found.violation = point.violation;
    found.converged = converged;
    progress.update(std::min(i + ranks, starts.size()));
    return found;
  });
}

/// The distinct feasible points, best first, each with the number of searches that ended there.
/// Searches that did not converge may have stopped on the way: only the best point is kept of them.
std::vector<LocalMaximum> distinct(std::vector<Found> found, const DesignProblem& problem) {
  constexpr double same = 1e-4;  // m
  const auto n = static_cast<Index>(problem.variables.size());
  std::erase_if(found, [](const Found& f) { return f.violation > feasibility_tolerance; });
  std::ranges::stable_sort(found, std::greater{}, &Found::objective);
  std::vector<LocalMaximum> maxima;
  for (const Found& f : found) {
    const LocalMaximum m{to_design(problem, Eigen::Map<const VectorXd>(f.x.data(), n)),
                         f.objective * problem.scales.front(), 1};
    const auto is_same = [&](const LocalMaximum& known) {
      const auto [a, b] = std::pair(known.design, m.design);
      return std::hypot(a.r1 - b.r1, a.r3 - b.r3, a.r2 - b.r2) < same;
    };
    const auto known = std::ranges::find_if(maxima, is_same);
    if (known != maxima.end())
      ++known->starts;
    else if (f.converged || maxima.empty())
      maxima.push_back(m);
  }
  return maxima;
}

/// The constraints that a design violates, for a message.
std::string violations_text(const DesignProblem& problem, const Design<double>& design) {
  const VectorXd values = values_at(problem, {&design, 1});
  std::vector<std::string> violated;
  for (std::size_t i = 0; i < problem.constraints.size(); ++i)
    if (values(static_cast<Index>(i) + 1) > 0) violated.push_back(to_text(problem.constraints[i]));
  return fmt::format("{} violates {}", to_text(design), fmt::join(violated, " and "));
}

/// Gradient and Hessian of the objective with respect to all three lengths.
void add_derivatives(const DesignProblem& problem, OptimumResult& result) {
  const std::array<double, 3> r = lengths(result.design);
  const auto functions = [&](const MatrixXd& points) {
    std::vector<Design<double>> designs;
    for (const auto& x : points.colwise())
      designs.push_back({x(0) * r[0], x(1) * r[1], x(2) * r[2]});
    result.designs += designs.size();
    return MatrixXd(values_at(problem, designs).row(0) * problem.scales.front());
  };
  const Expansion expansion = expand(functions, VectorXd::Ones(3), accurate_steps, true);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Index>(i);
    result.gradient[i] = expansion.gradients(0, row) / r[i];
    for (std::size_t j = 0; j < 3; ++j)
      result.hessian[i][j] = expansion.hessians.front()(row, static_cast<Index>(j)) / r[i] / r[j];
  }
}

/// The value of the objective at the optimum, its error and the release time.
void add_value(const DesignProblem& problem, OptimumResult& result) {
  const std::array fields{result.objective, Field::release_time};
  const MatrixXd values =
      field_values(problem.scene, problem.solver, Accuracy::high, {&result.design, 1}, fields);
  const ReferenceValue exact =
      reference_values(problem.scene, result.design, problem.solver, {fields.data(), 1}).front();
  result.value = values(0);
  result.release_time = values(1);
  result.error = std::abs(result.value - exact.value) + exact.bound;
}

/// The derivatives of the optimum with respect to all limits; the active ones are added.
VectorXd add_active_limits(const DesignProblem& problem, const KktPoint& optimum,
                           OptimumResult& result) {
  const std::vector<Limit> all = limits(problem);
  constexpr double rounding = 1e-9;  // of scaled multipliers
  VectorXd derivatives = optimum.multipliers;
  for (std::size_t i = 0; i < all.size(); ++i) {
    double& derivative = derivatives(static_cast<Index>(i));
    if (std::abs(derivative) < rounding) derivative = 0;
    derivative *= all[i].factor;
    if (derivative != 0) result.active.push_back({all[i].text, all[i].units, derivative});
  }
  return derivatives;
}

/// The sensitivities to all numeric keys of the scene, shared among the ranks. Collective.
std::vector<std::pair<std::string, Sensitivity>> all_sensitivities(const Job& job,
                                                                   const DesignProblem& problem,
                                                                   const Design<double>& design,
                                                                   const VectorXd& derivatives,
                                                                   MPI_Comm comm) {
  const std::vector<std::string> keys = numeric_scene_keys(job);
  const auto derived = mpi::share(keys.size(), comm, [&](std::size_t i) {
    return sensitivity(job, problem, keys[i], design, derivatives);
  });
  std::vector<std::pair<std::string, Sensitivity>> all;
  for (std::size_t i = 0; i < keys.size(); ++i)
    all.emplace_back(keys[i].substr(keys[i].find('.') + 1), derived[i]);
  return all;
}

/// Designs to search from, best first.
struct Starts {
  std::vector<Design<double>> designs;
  double increment;          ///< m: of the coarse sweep
  std::uint64_t integrated;  ///< designs
};

/// The best local maxima of the coarse sweeps. Throws NoOptimum if nothing is released. Collective.
Starts find_starts(const Job& job, const OptimumOptions& options, MPI_Comm comm) {
  const LatticeSpec spec =
      options.own_lattice ? job.lattice : coarse_lattice(job.scene, job.lattice);
  const CoarseSweep coarse = coarse_sweep(job, spec, options.progress, comm);
  Starts starts{best_of(coarse, max_starts), coarse.increment, coarse.designs};
  if (const auto edge = edge_lattice(job.scene, spec); edge && !options.own_lattice) {
    const CoarseSweep swept = coarse_sweep(job, *edge, options.progress, comm);
    std::ranges::copy(best_of(swept, max_edge_starts), std::back_inserter(starts.designs));
    starts.integrated += swept.designs;
  }
  if (starts.designs.empty())
    throw NoOptimum(
        fmt::format("nothing is released: none of {} designs with a spacing of {} m has a release",
                    starts.integrated, starts.increment));
  return starts;
}

[[noreturn]] void refuse_deviation(double deviation) {
  throw NoOptimum(
      fmt::format("no design was found that has a release and satisfies the constraints with all "
                  "lengths off by up to optimum.deviation = {} m",
                  deviation));
}

/// Searches from designs, and adds what is found to a result; collective.
template <class Search>
void find_maxima(const std::vector<Design<double>>& starts, const DesignProblem& problem,
                 ProgressStyle progress, MPI_Comm comm, Search search, OptimumResult& result) {
  const std::vector<Found> found = search_from(starts, progress, comm, search);
  for (const Found& f : found) result.designs += f.integrated;
  result.starts = starts.size();
  result.maxima = distinct(found, problem);
}

/// Takes the best of the local maxima. A last search gives its multipliers, and the derivatives of
/// the optimum with respect to all limits, which are returned: NaN if they do not exist.
template <class Search>
VectorXd take_best(const DesignProblem& problem, Search search, OptimumResult& result) {
  LocalMaximum& best = result.maxima.front();
  const KktPoint optimum = search(best.design, result.designs);
  best.design = result.design = to_design(problem, optimum.point.x);
  best.value = optimum.point.objective * problem.scales.front();
  result.converged = optimum.converged;
  return add_active_limits(problem, optimum, result);
}

}  // namespace

std::optional<OptimumResult> find_optimum(const Job& job, const OptimumOptions& given,
                                          MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  OptimumOptions options = given;
  // Only rank 0 reports progress, as if the others were as fast.
  if (mpi::rank(comm) != 0) options.progress = ProgressStyle::none;
  const DesignSpace space = design_space(job.scene, job.lattice);
  // A length that is off by as much may be zero or negative.
  if (job.optimum.robust != Robust::no && job.optimum.deviation >= std::ranges::min(space.upper))
    refuse_deviation(job.optimum.deviation);
  const Starts starts = find_starts(job, options, comm);
  OptimumResult result{};
  result.objective = job.optimum.objective;
  result.coarse_increment = starts.increment;
  result.designs = starts.integrated;

  const DesignProblem problem = design_problem(job, starts.designs.front());
  const auto search_nominal = [&](const Design<double>& start, std::uint64_t& integrated) {
    return search(nominal_program(problem, integrated), to_variables(problem, start));
  };
  find_maxima(starts.designs, problem, options.progress, comm, search_nominal, result);
  if (result.maxima.empty())
    throw NoOptimum(fmt::format("the constraints exclude every design: {}",
                                violations_text(problem, starts.designs.front())));
  VectorXd derivatives;
  if (job.optimum.robust == Robust::no) {
    derivatives = take_best(problem, search_nominal, result);
  } else {
    const double deviation = job.optimum.deviation;
    const auto search_robust = [&](const Design<double>& start, std::uint64_t& integrated) {
      return robust_search(problem, start, job.optimum.robust, deviation, integrated);
    };
    std::vector<Design<double>> maxima;
    for (const LocalMaximum& m : result.maxima) maxima.push_back(m.design);
    find_maxima(maxima, problem, options.progress, comm, search_robust, result);
    if (result.maxima.empty()) refuse_deviation(deviation);
    derivatives = take_best(problem, search_robust, result);
    derivatives.fill(nan);  // they are those of the worst or mean value
  }
  if (!result.converged) derivatives.fill(nan);

  result.sensitivities = all_sensitivities(job, problem, result.design, derivatives, comm);
  if (mpi::rank(comm) != 0) return std::nullopt;
  add_value(problem, result);
  add_derivatives(problem, result);
  result.allowances = allowances(problem, result.design, result.designs);
  if (job.optimum.deviation > 0)
    result.robustness = robustness(problem, result.design, job.optimum.deviation, result.designs);
  result.seconds = MPI_Wtime() - start_time;
  return result;
}

std::optional<RefinedOptimum> refine(const Job& job, const Design<double>& start) {
  std::uint64_t integrated = 0;
  const DesignProblem problem = design_problem(job, start);
  const NonlinearProgram program = nominal_program(problem, integrated);
  const Point point = search(program, to_variables(problem, start)).point;
  if (!is_feasible(point)) return std::nullopt;
  const Design<double> design = to_design(problem, point.x);
  const std::array fields{job.optimum.objective, Field::speed, Field::release_time};
  const VectorXd values = field_values(job.scene, job.solver, Accuracy::high, {&design, 1}, fields);
  const VectorXd others =
      field_values(job.scene, job.solver, Accuracy::check, {&design, 1}, fields);
  return RefinedOptimum{{design, values(0), values(1), values(2)}, std::abs(values(0) - others(0))};
}

}  // namespace trebsweep
