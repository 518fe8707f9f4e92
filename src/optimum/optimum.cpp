#include "trebsweep/optimum/optimum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/optimum/allowance.hpp"
#include "trebsweep/optimum/derivatives.hpp"
#include "trebsweep/optimum/design_space.hpp"
#include "trebsweep/optimum/field_values.hpp"
#include "trebsweep/optimum/local_search.hpp"
#include "trebsweep/optimum/safety.hpp"
#include "trebsweep/optimum/starts.hpp"
#include "trebsweep/swing/reference.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

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
  const DesignSpace given = design_space(job.scene, job.lattice);
  if (job.optimum.robust == Robust::no) return;
  const DesignSpace space = robust_space(job.scene, given, deviation);
  for (std::size_t d = 0; d < 3; ++d)
    if (space.lower[d] > space.upper[d] || deviation >= space.upper[d]) refuse_deviation(deviation);
}

bool is_feasible(const DesignProblem& problem, const Design<double>& design) {
  const MatrixXd values = values_at(problem, {&design, 1});
  return values.allFinite() &&
         (values.bottomRows(values.rows() - 1).array() <= feasibility_tolerance).all();
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

/// Replaces the optimum by the best safe design, if it is not safe itself: one of the other local
/// maxima, or the best safe design near one. Throws NoOptimum if none is found. Collective.
void take_safe(const Job& job, const DesignProblem& problem, ProgressStyle style, MPI_Comm comm,
               OptimumResult& result) {
  constexpr std::size_t most = 12;  // maxima to search around
  const double deviation = job.optimum.deviation;
  const auto is_good = [&](const Design<double>& design, std::uint64_t& integrated) {
    return is_feasible(problem, design) && is_safe(problem, design, deviation, integrated);
  };
  if (is_good(result.design, result.designs)) return;
  result.unsafe = {result.design, result.value};
  std::vector<Design<double>> maxima;
  for (const LocalMaximum& m : result.maxima)
    if (maxima.size() < most) maxima.push_back(m.design);
  const auto search_safe = [&](const Design<double>& start, std::uint64_t& integrated) {
    const auto safe = is_good(start, integrated)
                          ? std::optional(start)
                          : safe_design_near(problem, start, deviation, integrated);
    if (!safe) return KktPoint{{VectorXd::Zero(0), 0, HUGE_VAL}, {}, false};
    const double value = values_at(problem, {&*safe, 1})(0, 0);
    return KktPoint{{to_variables(problem, *safe), value, 0}, {}, false};
  };
  const auto found = find_maxima(maxima, search_safe, style, comm, result.designs);
  if (found.empty())
    throw NoOptimum(
        fmt::format("the {} or a constraint jumps next to every good design found, such as {} with "
                    "{:.6g}: lengths that are "
                    "off by {} would lose it; choose other axes, release or constraints",
                    info(job.optimum.objective).name, to_text(result.design), result.value,
                    deviation > 0 ? fmt::format("{} m", deviation) : "0.1 %"));
  const LocalMaximum best = distinct({found.front()}, problem).front();
  result.design = best.design;
  result.converged = false;
  result.active.clear();
}

/// Throws NoOptimum if the objective grows without limit as r1 approaches an open bound, next to
/// which the optimum is: if it grows as much from 1 um to 1 nm as from 1 mm to 1 um.
void refuse_divergence(const Job& job, const DesignProblem& problem, OptimumResult& result) {
  if (job.lattice.r1) return;
  const double bound = problem.space.lower[0];
  if (result.design.r1 - bound > 1e-3 * bound) return;
  std::vector<Design<double>> designs(3, result.design);
  for (std::size_t i = 0; i < 3; ++i)
    designs[i].r1 = bound + std::pow(10, -3.0 * static_cast<double>(i + 1));
  const VectorXd values = values_at(problem, designs).row(0) * problem.scales.front();
  result.designs += designs.size();
  if (!(values(2) - values(1) > 0.5 * (values(1) - values(0)) && values(1) > values(0))) return;
  throw NoOptimum(fmt::format(
      "the largest {} is not reached: it grows without limit as r1 approaches its open bound "
      "{} = {:.6g} m (47): {:.4g}, {:.4g} and {:.4g} {} at 1 mm, 1 um and 1 nm from it",
      info(job.optimum.objective).name, arm_bounds(job.scene).low_text, bound, values(0), values(1),
      values(2), info(job.optimum.objective).units));
}

/// The fields that a builder needs to know, as far as the scene has them.
std::vector<BuildValue> build_values(const DesignProblem& problem, const Design<double>& design) {
  std::vector<Field> fields{Field::speed,
                            Field::range,
                            Field::efficiency,
                            Field::release_time,
                            Field::arm_angle,
                            Field::pin_angle,
                            Field::impact_speed,
                            Field::ground_clearance,
                            Field::tip_clearance,
                            Field::counterweight_clearance,
                            Field::projectile_clearance,
                            Field::least_sling_tension,
                            Field::peak_sling_tension};
  if (problem.scene.counterweight_hanger > 0) {
    fields.push_back(Field::least_hanger_tension);
    fields.push_back(Field::peak_hanger_tension);
  }
  fields.push_back(Field::peak_axle_load);
  if (has_beam_stress(problem.scene)) fields.push_back(Field::peak_beam_stress);
  const VectorXd values =
      field_values(problem.scene, problem.solver, Accuracy::high, {&design, 1}, fields);
  std::vector<BuildValue> all;
  for (std::size_t i = 0; i < fields.size(); ++i)
    all.push_back({fields[i], values(static_cast<Index>(i))});
  return all;
}

/// The range in other winds of a projectile that feels drag, released by the same pin.
std::optional<WindRange> range_with_wind(const DesignProblem& problem,
                                         const Design<double>& design) {
  if (problem.scene.projectile_diameter == 0) return std::nullopt;
  const auto value = [&](Field field, const Scene& scene, const Solver& solver) {
    return field_values(scene, solver, Accuracy::high, {&design, 1}, {&field, 1})(0);
  };
  Solver pinned = problem.solver;
  pinned.release = Release::pin;
  pinned.pin_angle = value(Field::pin_angle, problem.scene, problem.solver);
  const auto range_in = [&](double wind) {
    Scene scene = problem.scene;
    scene.wind += wind;
    return value(Field::range, scene, pinned);
  };
  const WindRange range{range_in(-WindRange::speed), range_in(WindRange::speed)};
  return std::isfinite(range.less + range.more) ? std::optional(range) : std::nullopt;
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
  const Starts starts = find_starts(job, options.own_lattice, options.progress, comm);
  OptimumResult result{};
  result.objective = job.optimum.objective;
  result.coarse_increment = starts.increment;
  result.designs = starts.integrated;

  // Conditions that the best design satisfies anyway need not slow down the search.
  DesignProblem problem = design_problem(given_job, starts.designs.front());
  const DesignProblem full = design_problem(job, starts.designs.front());
  const bool is_full = problem.constraints.size() == full.constraints.size();
  const auto search_all = [&] {
    return find_maxima(starts.designs, problem, options.progress, comm, result.designs);
  };
  std::vector<Found> found = search_all();
  if (!is_full && !found.empty() &&
      (job.optimum.robust != Robust::no ||
       !is_feasible(full, distinct(found, problem).front().design))) {
    problem = full;
    found = search_all();
  }
  result.starts = starts.designs.size();
  if (found.empty()) refuse_constraints(full, starts);
  result.maxima = distinct(found, problem);
  VectorXd derivatives;
  if (job.optimum.robust == Robust::no) {
    const auto search_again = [&](const Design<double>& start, std::uint64_t& integrated) {
      return search(nominal_program(problem, integrated), to_variables(problem, start));
    };
    derivatives = take_best(problem, search_again, result);
    result.value = result.maxima.front().value;
    refuse_divergence(job, problem, result);
    take_safe(job, full, options.progress, comm, result);
  } else {
    problem.space = robust_space(job.scene, problem.space, deviation);
    const auto search_robust = [&](const Design<double>& start, std::uint64_t& integrated) {
      return robust_search(problem, start, job.optimum.robust, deviation, integrated);
    };
    std::vector<Design<double>> maxima;
    for (const LocalMaximum& m : result.maxima)
      if (m.converged || maxima.empty()) maxima.push_back(m.design);
    found = find_maxima(maxima, search_robust, options.progress, comm, result.designs);
    if (found.empty()) refuse_deviation(deviation);
    result.starts = maxima.size();
    result.maxima = distinct(found, problem);
    derivatives = take_best(problem, search_robust, result);
    derivatives.fill(nan);  // they are those of the worst or mean value
  }
  // Of searches that did not converge, some may have stopped on the way.
  std::erase_if(result.maxima, [&](const LocalMaximum& m) {
    return !m.converged && &m != &result.maxima.front();
  });
  if (!result.converged) derivatives.setConstant(limits(problem).size(), nan);

  result.sensitivities = all_sensitivities(job, problem, result.design, derivatives, comm);
  if (mpi::rank(comm) != 0) return std::nullopt;
  add_value(problem, result);
  result.values = build_values(problem, result.design);
  add_derivatives(problem, result);
  result.allowances = allowances(problem, result.design, result.designs);
  result.pin_allowance = pin_allowance(problem, result.design, result.designs);
  if (result.pin_allowance) result.range_with_wind = range_with_wind(problem, result.design);
  if (deviation > 0)
    result.robustness = robustness(problem, result.design, deviation, result.designs);
  result.seconds = MPI_Wtime() - start_time;
  return result;
}

std::optional<BestDesign> refine(const Job& job, const Design<double>& start) {
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
  BestDesign best;
  best.value = values(0);
  best.speed = values(1);
  best.design = design;
  best.release_time = values(2);
  best.error = std::abs(values(0) - others(0));
  return best;
}

}  // namespace trebsweep
