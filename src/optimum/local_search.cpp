#include "trebsweep/optimum/local_search.hpp"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <vector>

#include "trebsweep/optimum/derivatives.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A program as NLopt calls it: the variables are x and, if there are several objectives, a bound t
/// of all of them, which is then the objective.
class NloptProblem {
 public:
  NloptProblem(const NonlinearProgram& program, const VectorXd& start) : program_(program) {
    evaluate(start);
  }

  bool has_bound() const { return program_.objectives > 1; }
  Index variables() const { return program_.variables() + has_bound(); }
  Index constraints() const {
    return program_.constraints + (has_bound() ? program_.objectives : 0);
  }
  const Point& best() const { return best_; }

  double objective(const double* y, double* gradient) {
    if (has_bound()) {
      if (gradient) std::fill_n(gradient, variables(), 0.0), gradient[variables() - 1] = 1;
      return y[variables() - 1];
    }
    evaluate(Eigen::Map<const VectorXd>(y, program_.variables()));
    if (gradient) copy_row(0, 1, gradient);
    return value(0, -HUGE_VAL);
  }

  void constrain(double* result, const double* y, double* gradient) {
    evaluate(Eigen::Map<const VectorXd>(y, program_.variables()));
    Index i = 0;
    const auto next_gradient = [&] { return gradient + variables() * i; };
    if (has_bound())
      for (; i < program_.objectives; ++i) {
        result[i] = y[variables() - 1] - value(i, -HUGE_VAL);
        if (gradient) copy_row(i, -1, next_gradient()), next_gradient()[variables() - 1] = 1;
      }
    for (Index f = program_.objectives; i < constraints(); ++i, ++f) {
      result[i] = value(f, HUGE_VAL);
      if (gradient) copy_row(f, 1, next_gradient());
    }
  }

 private:
  /// Expands the functions at x and keeps the best point.
  void evaluate(const VectorXd& x) {
    if (at_.size() > 0 && x == at_) return;
    at_ = x;
    expansion_ = expand(program_.functions, x, {1e-3, 3}, false);
    const Point point = point_of(program_, x, expansion_.values);
    if (best_.x.size() == 0 || is_better(point, best_)) best_ = point;
  }

  double value(Index function, double otherwise) const {
    const double value = expansion_.values(function);
    return std::isnan(value) ? otherwise : value;
  }

  void copy_row(Index function, double factor, double* to) const {
    for (Index i = 0; i < program_.variables(); ++i) {
      const double slope = factor * expansion_.gradients(function, i);
      to[i] = std::isfinite(slope) ? slope : 0;
    }
  }

  const NonlinearProgram& program_;
  VectorXd at_;  // the point of the expansion
  Expansion expansion_;
  Point best_;
};

/// The best point that NLopt visits.
Point search_by_nlopt(const NonlinearProgram& program, const VectorXd& start) {
  NloptProblem problem(program, start);
  const auto n = static_cast<unsigned>(problem.variables());
  const auto with_bound = [&](const VectorXd& x, double t) {
    std::vector<double> y(x.begin(), x.end());
    if (problem.has_bound()) y.push_back(t);
    return y;
  };
  nlopt::opt opt(nlopt::LD_MMA, n);
  opt.set_lower_bounds(with_bound(program.lower, -HUGE_VAL));
  opt.set_upper_bounds(with_bound(program.upper, HUGE_VAL));
  opt.set_max_objective(
      [](unsigned, const double* y, double* gradient, void* data) {
        return static_cast<NloptProblem*>(data)->objective(y, gradient);
      },
      &problem);
  if (problem.constraints() > 0)
    opt.add_inequality_mconstraint(
        [](unsigned, double* result, unsigned, const double* y, double* gradient, void* data) {
          static_cast<NloptProblem*>(data)->constrain(result, y, gradient);
        },
        &problem, std::vector<double>(static_cast<std::size_t>(problem.constraints()), 0.0));
  opt.set_xtol_abs(1e-5);
  opt.set_maxeval(60);
  std::vector<double> y = with_bound(problem.best().x, problem.best().objective);
  double value = 0;
  try {
    opt.optimize(y, value);
  } catch (const std::runtime_error&) {
    // Limited by rounding errors, or failed: the best point is kept all the same.
  }
  return problem.best();
}

/// The best point of a cubic lattice around a point, with `reach` points to each side of it.
Point best_around(const NonlinearProgram& program, const Point& centre, double spacing,
                  Index reach) {
  const Index n = program.variables(), width = 2 * reach + 1;
  const auto count = static_cast<Index>(std::lround(std::pow(width, n)));
  MatrixXd points(n, count);
  for (Index p = 0; p < count; ++p)
    for (Index i = 0, rest = p; i < n; ++i, rest /= width) {
      const double x = centre.x(i) + spacing * static_cast<double>(rest % width - reach);
      points(i, p) = std::clamp(x, program.lower(i), program.upper(i));
    }
  const MatrixXd values = program.functions(points);
  Point best = centre;
  for (Index p = 0; p < count; ++p) {
    const Point point = point_of(program, points.col(p), values.col(p));
    if (is_better(point, best)) best = point;
  }
  return best;
}

/// Descends to finer and finer lattices: for functions with a kink at the optimum.
Point zoom(const NonlinearProgram& program, Point point) {
  constexpr int max_steps = 60;
  double spacing = 1e-2;
  for (int step = 0; spacing > 1e-10 && step < max_steps; ++step) {
    const Point best = best_around(program, point, spacing, 2);
    if (is_better(best, point))
      point = best;
    else
      spacing /= 3;
  }
  return point;
}

}  // namespace

KktPoint search(const NonlinearProgram& program, const VectorXd& x) {
  constexpr int rounds = 4;
  constexpr double spacing = 1e-3, largest_spacing = 0.1;
  // Relative: so much the objective may gain from violations within feasibility_tolerance.
  constexpr double noise = 1e-8;
  if (program.variables() == 0)
    return {best_around(program, {x, 0, HUGE_VAL}, 0, 0), VectorXd::Zero(program.constraints),
            true};
  KktPoint best;
  Point start = best_around(program, {x, 0, HUGE_VAL}, spacing, 0);
  // Away from points without a value.
  for (double far = 10 * spacing; std::isinf(start.violation) && far <= largest_spacing; far *= 2)
    start = best_around(program, start, far, 2);
  for (int round = 0; round < rounds; ++round) {
    const Point near = search_by_nlopt(program, start.x);
    KktPoint found = solve_kkt(program, near);
    if (!found.converged ||
        (is_better(near, found.point) &&
         near.objective - found.point.objective > noise * std::abs(near.objective)))
      found = {zoom(program, near), VectorXd::Zero(found.multipliers.size()), false};
    if (round == 0 || is_better(found.point, best.point)) best = found;
    const Point around = best_around(program, best.point, spacing, 3);
    if (!is_better(around, best.point) ||
        (is_feasible(best.point) &&
         around.objective - best.point.objective <= noise * std::abs(best.point.objective)))
      break;
    start = around;
  }
  return best;
}

}  // namespace trebsweep
