#include "trebsweep/optimum/optimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <ranges>
#include <utility>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/optimum/description.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/optimum/safety.hpp"
#include "trebsweep/optimum/starts.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Adds the active limits of an optimum, with what they are worth.
void add_active_limits(const DesignProblem& problem, const ProblemOptimum& optimum,
                       OptimumResult& result) {
  const std::vector<Limit> all = limits(problem);
  for (std::size_t i = 0; i < all.size(); ++i) {
    double derivative = 0;
    for (const PartOptimum& part : optimum.parts)
      derivative += part.derivatives(static_cast<Index>(i));
    if (derivative != 0) result.active.push_back({all[i].text, all[i].units, derivative});
  }
}

/// The sensitivities to all numeric keys of the scene, shared among the ranks. Collective.
std::vector<std::pair<std::string, Sensitivity>> all_sensitivities(const Job& job,
                                                                   const ProblemOptimum& optimum,
                                                                   const Parameters& parameters,
                                                                   MPI_Comm comm) {
  const std::vector<std::string> keys = numeric_scene_keys(job);
  const auto derived = mpi::share(keys.size(), comm, [&](std::size_t i) {
    return sensitivity(job, keys[i], parameters, optimum.parts);
  });
  std::vector<std::pair<std::string, Sensitivity>> all;
  for (std::size_t i = 0; i < keys.size(); ++i)
    all.emplace_back(keys[i].substr(keys[i].find('.') + 1), derived[i]);
  return all;
}

[[noreturn]] void refuse_deviation(double deviation) {
  throw NoOptimum(
      fmt::format("no design was found that has a release and satisfies the constraints with all "
                  "lengths off by up to optimum.deviation = {} m",
                  deviation));
}

/// Throws NoOptimum if no design is possible, in a robust search with all lengths off by the
/// deviation.
void refuse_empty_space(const Job& job) {
  const double deviation = job.optimum.deviation;
  const DesignSpace given = design_space(job);
  if (job.optimum.robust == Robust::no) return;
  const DesignSpace space = robust_space(job, given, deviation);
  for (Index d = 0; d < length_count; ++d)
    if (space.lower(d) > space.upper(d) || deviation >= space.upper(d)) refuse_deviation(deviation);
}

/// Whether the values of a design problem, of one design, exist and satisfy its constraints.
bool are_feasible(const MatrixXd& values) {
  return values.allFinite() &&
         (values.bottomRows(values.rows() - 1).array() <= feasibility_tolerance).all();
}

/// Takes the best of the local maxima. A last search gives its derivatives with respect to limits,
/// and is returned.
ProblemOptimum take_best(const DesignProblem& problem, const Search& search,
                         OptimumResult& result) {
  LocalMaximum& best = result.maxima.front();
  const ProblemOptimum optimum = search(best.parameters, result.designs);
  best.parameters = result.parameters = to_parameters(problem, optimum.point.x);
  best.value = optimum.point.objective * problem.scales.front();
  result.converged = optimum.converged;
  add_active_limits(problem, optimum, result);
  return optimum;
}

/// Those of some starts that are feasible and better than a value.
std::vector<Parameters> better_starts(const DesignProblem& problem,
                                      const std::vector<Parameters>& starts, double value,
                                      std::uint64_t& integrated) {
  MatrixXd all(problem.space.size(), std::ssize(starts));
  for (Index i = 0; i < all.cols(); ++i) all.col(i) = starts[static_cast<std::size_t>(i)];
  integrated += starts.size();
  const MatrixXd values = values_at(problem, all);
  std::vector<Parameters> better;
  for (Index i = 0; i < all.cols(); ++i)
    if (are_feasible(values.col(i)) && values(0, i) * problem.scales.front() > value)
      better.push_back(all.col(i));
  return better;
}

/// Replaces the optimum by the best safe design, if it is not safe itself: one of the other local
/// maxima, or the best safe design near a better one, near one where a search has stopped, or near
/// a better start. Throws NoOptimum if none is found. Collective.
void take_safe(const Job& job, const DesignProblem& problem, const std::vector<Parameters>& starts,
               ProgressStyle style, MPI_Comm comm, OptimumResult& result) {
  constexpr std::size_t most = 12, at_a_time = 4;  // maxima to search around
  const double deviation = job.optimum.deviation;
  const auto is_safe = [&](const LocalMaximum& m) {
    ++result.designs;
    return are_feasible(values_at(problem, m.parameters)) &&
           are_safe(problem, m.parameters, deviation, Accuracy::high, result.designs);
  };
  if (is_safe(result.maxima.front())) return;
  result.unsafe = {result.parameters, result.value};
  std::optional<LocalMaximum> best;
  std::size_t tried = 0;
  for (const LocalMaximum& m : result.maxima | std::views::drop(1))
    if (!best && m.converged && tried++ < most && is_safe(m)) best = m;
  const auto search_safe = [&](const Parameters& start, std::uint64_t& integrated) {
    const auto safe = safe_parameters_near(problem, start, deviation, integrated);
    if (!safe) return ProblemOptimum{{VectorXd::Zero(0), 0, HUGE_VAL}, false, {}};
    const double value = values_at(problem, *safe)(0, 0);
    return ProblemOptimum{{to_scaled(problem, *safe), value, 0}, false, {}};
  };
  const auto value_of_best = [&] { return best ? best->value : -HUGE_VAL; };
  const auto search_all = [&](const std::vector<Parameters>& from) {
    const auto found = find_maxima(from, search_safe, style, comm, result.designs);
    if (found.empty()) return;
    const LocalMaximum first = distinct({found.front()}, problem).front();
    if (first.value > value_of_best()) best = first;
  };
  // A few at a time: the best safe design so far is often better than what is left.
  std::size_t searched = 0;
  for (auto m = result.maxima.begin(); m != result.maxima.end() && searched < most;) {
    std::vector<Parameters> some;
    for (; m != result.maxima.end() && some.size() < at_a_time; ++m)
      if (m->value > value_of_best() || !m->converged) some.push_back(m->parameters);
    searched += some.size();
    search_all(some);
  }
  search_all(better_starts(problem, starts, value_of_best(), result.designs));
  if (!best)
    throw NoOptimum(fmt::format(
        "no safe design was found: the {} or a constraint jumps next to good ones, such as {}: "
        "lengths that are off by {} would lose it; choose other axes, release or "
        "constraints",
        shown(job.optimum.objective).text, to_text(result.parameters, job.optimum.variables),
        deviation > 0 ? fmt::format("{} m", deviation) : "0.1 %"));
  if (best->value >= result.unsafe->value) result.unsafe.reset();  // from another start
  result.parameters = best->parameters;
  result.converged = false;
  result.active.clear();
}

/// Throws NoOptimum if the objective grows without limit as r1 approaches an open bound, next to
/// which the optimum is: if it grows as much from 1 um to 1 nm as from 1 mm to 1 um.
void refuse_divergence(const Job& job, const DesignProblem& problem, OptimumResult& result) {
  if (job.lattice.r1) return;
  const ArmBounds arm = arm_bounds(at(problem.machine, result.parameters).scene);
  const double bound = arm.low;
  if (result.parameters(0) - bound > 1e-3 * bound) return;
  MatrixXd points = result.parameters.replicate(1, 3);
  points.row(0) = Eigen::RowVector3d(1e-3, 1e-6, 1e-9).array() + bound;
  const VectorXd values = values_at(problem, points).row(0) * problem.scales.front();
  result.designs += static_cast<std::uint64_t>(points.cols());
  if (!(values(2) - values(1) > 0.5 * (values(1) - values(0)) && values(1) > values(0))) return;
  const ShownObjective objective = shown(job.optimum.objective);
  const double sign = objective.sign;
  throw NoOptimum(fmt::format(
      "the {} {} is not reached: it {} without limit as r1 approaches its open bound "
      "{} = {:.6g} m (47): {:.4g}, {:.4g} and {:.4g} {} at 1 mm, 1 um and 1 nm from it",
      objective.extreme, objective.text, sign > 0 ? "grows" : "falls", arm.low_text, bound,
      sign * values(0), sign * values(1), sign * values(2), job.optimum.objective.unit));
}

/// Whether the objective is a target that parameters meet.
bool meet_target(const DesignProblem& problem, const Parameters& parameters) {
  constexpr double met = 1e-6;
  return problem.objective.distance < 0 &&
         std::abs(values_at(problem, parameters)(0)) <= met * magnitude_at(problem, parameters);
}

/// Whether most of some searches have ended at the best of their feasible ends, a converged one, or
/// this meets a target, as others may.
bool do_agree(const std::vector<Found>& found, std::size_t searches, const DesignProblem& problem) {
  if (found.empty()) return false;
  const LocalMaximum best = distinct(found, problem).front();
  return (best.converged && 2 * best.starts > searches) || meet_target(problem, best.parameters);
}

/// Finds the local maxima of a job, all conditions of which are in `full`, and returns the problem
/// that they belong to. Conditions that the best design satisfies anyway need not slow down the
/// search from starts that may violate them. Collective.
DesignProblem find_local_maxima(const Job& given_job, const Job& job, const DesignProblem& full,
                                const Starts& starts, ProgressStyle style, MPI_Comm comm,
                                OptimumResult& result) {
  DesignProblem problem =
      job.optimum.variables.empty() ? design_problem(given_job, starts.parameters.front()) : full;
  const bool is_full = problem.constraints.size() == full.constraints.size();
  const auto search_all = [&] {
    result.starts = starts.parameters.size();
    auto found = find_maxima(starts.parameters, problem, style, comm, result.designs);
    if (job.optimum.variables.empty() || do_agree(found, result.starts, problem)) return found;
    const auto more = evolved(problem, starts, style, comm, result.designs);
    result.starts += more.size();
    merge(found, find_maxima(more, problem, style, comm, result.designs));
    return found;
  };
  std::vector<Found> found = search_all();
  if (!is_full && !found.empty() &&
      (job.optimum.robust != Robust::no ||
       !are_feasible(values_at(full, distinct(found, problem).front().parameters)))) {
    problem = full;
    found = search_all();
  }
  if (found.empty()) refuse_constraints(full, starts);
  result.maxima = distinct(found, problem);
  return problem;
}

/// Finds the local maxima of the worst or mean value, from those of the value, and takes the best.
/// Collective.
ProblemOptimum take_robust(const Job& job, const DesignProblem& problem, ProgressStyle style,
                           MPI_Comm comm, OptimumResult& result) {
  const double deviation = job.optimum.deviation;
  const auto search_robust = [&](const Parameters& start, std::uint64_t& integrated) {
    return undivided(problem,
                     robust_search(problem, start, job.optimum.robust, deviation, integrated));
  };
  std::vector<Parameters> maxima;
  for (const LocalMaximum& m : result.maxima)
    if (m.converged || maxima.empty()) maxima.push_back(m.parameters);
  const auto found = find_maxima(maxima, search_robust, style, comm, result.designs);
  if (found.empty()) refuse_deviation(deviation);
  result.starts = maxima.size();
  result.maxima = distinct(found, problem);
  ProblemOptimum optimum = take_best(problem, search_robust, result);
  optimum.parts.front().derivatives.fill(nan);  // they are those of the worst or mean value
  return optimum;
}

/// Takes the derivatives from an optimum that has none, where the target is met or the search has
/// not converged.
void drop_derivatives(const DesignProblem& problem, OptimumResult& result,
                      ProblemOptimum& optimum) {
  result.is_on_target = meet_target(problem, result.parameters);
  if (result.is_on_target) {
    result.converged = false;
    result.active.clear();
  }
  if (!result.converged)
    optimum.parts = {{problem, 1, VectorXd::Constant(std::ssize(limits(problem)), nan)}};
  result.has_kink =
      std::ranges::count_if(optimum.parts, [](const auto& part) { return part.weight > 0; }) > 1;
}

}  // namespace

std::optional<OptimumResult> find_optimum(const Job& given_job, const OptimumOptions& given,
                                          MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Job job = searched_job(given_job);
  OptimumOptions options = given;
  // Only rank 0 reports progress, as if the others were as fast.
  if (mpi::rank(comm) != 0) options.progress = ProgressStyle::none;
  const double deviation = job.optimum.deviation;
  refuse_empty_space(job);
  Starts starts = find_starts(job, options.own_lattice, options.progress, comm);
  starts.parameters.insert(starts.parameters.end(), given.starts.begin(), given.starts.end());
  OptimumResult result{};
  result.objective = job.optimum.objective;
  result.coarse_increment = starts.increment;
  result.designs = starts.integrated;

  const DesignProblem full = design_problem(job, starts.parameters.front());
  DesignProblem problem =
      find_local_maxima(given_job, job, full, starts, options.progress, comm, result);
  ProblemOptimum optimum;
  if (job.optimum.robust == Robust::no) {
    const auto search_again = [&](const Parameters& start, std::uint64_t& integrated) {
      return search(problem, start, Effort::thorough, integrated);
    };
    optimum = take_best(problem, search_again, result);
    result.value = result.maxima.front().value;
    refuse_divergence(job, problem, result);
    take_safe(job, full, starts.parameters, options.progress, comm, result);
  } else {
    problem.space = robust_space(job, problem.space, deviation);
    optimum = take_robust(job, problem, options.progress, comm, result);
  }
  // Of searches that did not converge, some may have stopped on the way.
  std::erase_if(result.maxima, [&](const LocalMaximum& m) {
    return !m.converged && &m != &result.maxima.front();
  });
  drop_derivatives(problem, result, optimum);

  const Job found_job =
      with_variables(job, result.parameters.tail(std::ssize(job.optimum.variables)));
  if (!result.is_on_target)
    result.sensitivities = all_sensitivities(found_job, optimum, result.parameters, comm);
  if (mpi::rank(comm) != 0) return std::nullopt;
  describe(problem, deviation, result);
  result.seconds = MPI_Wtime() - start_time;
  return result;
}

std::optional<BestDesign> refine(const Job& given_job, const Design<double>& start) {
  Job job = given_job;
  job.optimum.variables.clear();
  std::uint64_t integrated = 0;
  const DesignProblem problem = design_problem(job, to_parameters(start));
  const Point point = search(problem, to_parameters(start), Effort::thorough, integrated).point;
  if (!is_feasible(point)) return std::nullopt;
  const Parameters parameters = to_parameters(problem, point.x);
  std::vector<Field> fields = job.optimum.objective.fields;
  fields.insert(fields.end(), {Field::speed, Field::release_time});
  BestDesign best;
  best.design = to_design(parameters);
  const auto objective = [&](const VectorXd& values) {
    return job.optimum.objective.value(
        {job.scene, best.design, fields, {values.data(), fields.size()}});
  };
  const VectorXd values = field_values(problem.machine, Accuracy::high, parameters, fields);
  const VectorXd others = field_values(problem.machine, Accuracy::check, parameters, fields);
  best.value = objective(values);
  best.speed = values(values.size() - 2);
  best.release_time = values(values.size() - 1);
  best.error = std::abs(best.value - objective(others));
  return best;
}

}  // namespace trebsweep
