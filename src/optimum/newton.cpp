#include "trebsweep/optimum/newton.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "trebsweep/optimum/derivatives.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Inequalities c(y) <= 0 with y = (x, t), of which t is to be maximized: t <= f(x) for each
/// objective f, the constraints, and the bounds.
struct Inequalities {
  VectorXd values;
  MatrixXd gradients;              // a row per inequality
  std::vector<MatrixXd> hessians;  // with respect to x; of the objectives and constraints
  bool is_quick;                   // whether the derivatives are those of quick_steps
};

/// The inequalities at a point; with the second derivatives `hessians`, unless these are empty.
Inequalities inequalities(const NonlinearProgram& program, const VectorXd& x, const Steps& steps,
                          const std::vector<MatrixXd>& hessians = {}) {
  const Index n = program.variables(), functions = program.objectives + program.constraints;
  const Expansion e = expand(program.functions, x, steps, hessians.empty(), program.domain);
  Inequalities c{VectorXd(functions + 2 * n), MatrixXd::Zero(functions + 2 * n, n + 1), e.hessians,
                 false};
  const double t = e.values.head(program.objectives).minCoeff();
  c.values << t - e.values.head(program.objectives).array(), e.values.tail(program.constraints),
      program.lower - x, x - program.upper;
  c.gradients.topLeftCorner(functions, n) = e.gradients;
  for (Index f = 0; f < program.objectives; ++f) {
    c.gradients.row(f).head(n) *= -1;
    c.gradients(f, n) = 1;
    if (hessians.empty()) c.hessians[static_cast<std::size_t>(f)] *= -1;
  }
  if (!hessians.empty()) c.hessians = hessians;
  c.gradients.block(functions, 0, n, n) = -MatrixXd::Identity(n, n);
  c.gradients.block(functions + n, 0, n, n) = MatrixXd::Identity(n, n);
  return c;
}

/// A step of y, the multipliers of all inequalities, and the residual of the equations solved,
/// which have no solution where the model is unbounded.
struct Step {
  VectorXd d, multipliers;
  double residual;
};

/// The second derivatives of the Lagrangian, so that the stationary point of its model on the
/// active set is a maximum: in the tangent space of the set, positive eigenvalues change their
/// signs.
MatrixXd lagrangian_hessian(const Inequalities& c, const VectorXd& multipliers,
                            const std::vector<Index>& active) {
  const Index n = c.gradients.cols() - 1;
  MatrixXd hessian = MatrixXd::Zero(n, n);
  for (std::size_t f = 0; f < c.hessians.size(); ++f)
    hessian -= multipliers(static_cast<Index>(f)) * c.hessians[f];
  const Eigen::FullPivLU<MatrixXd> factors(c.gradients(active, Eigen::all));
  if (factors.dimensionOfKernel() == 0) return hessian;  // a vertex
  const MatrixXd kernel = factors.kernel().topRows(n);
  const MatrixXd tangents =
      kernel.householderQr().householderQ() * MatrixXd::Identity(n, kernel.cols());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> reduced(tangents.transpose() * hessian * tangents);
  const double rounding = 1e-9 * hessian.norm();
  const VectorXd excess =
      reduced.eigenvalues().unaryExpr([&](double e) { return e > rounding ? 2 * e : 0; });
  const MatrixXd directions = tangents * reduced.eigenvectors();
  return hessian - directions * excess.asDiagonal() * directions.transpose();
}

/// The step to the stationary point of the Lagrangian's quadratic model on the linearized active
/// set; `multipliers` are those of the last step.
Step equality_step(const Inequalities& c, const VectorXd& multipliers,
                   const std::vector<Index>& active) {
  const Index n = c.gradients.cols(), m = static_cast<Index>(active.size());
  MatrixXd kkt = MatrixXd::Zero(n + m, n + m);
  VectorXd right = VectorXd::Zero(n + m);
  kkt.topLeftCorner(n - 1, n - 1) = lagrangian_hessian(c, multipliers, active);
  for (Index k = 0; k < m; ++k) {
    const Index i = active[static_cast<std::size_t>(k)];
    kkt.row(n + k).head(n) = c.gradients.row(i);
    kkt.col(n + k).head(n) = -c.gradients.row(i).transpose();
    right(n + k) = -c.values(i);
  }
  right(n - 1) = -1;  // the gradient of t
  const VectorXd solution = kkt.fullPivLu().solve(right);
  Step step{solution.head(n), VectorXd::Zero(c.values.size()), (kkt * solution - right).norm()};
  for (Index k = 0; k < m; ++k)
    step.multipliers(active[static_cast<std::size_t>(k)]) = solution(n + k);
  return step;
}

/// The same, with the active set found: inequalities with a negative multiplier leave it, and those
/// that the step would violate join it.
Step step_with_active_set(const Inequalities& c, const VectorXd& multipliers,
                          std::vector<Index>& active) {
  Step step;
  for (Index changes = 0; changes < 4 * c.values.size(); ++changes) {
    step = equality_step(c, multipliers, active);
    Index worst = 0;
    if (step.multipliers.minCoeff(&worst) < -1e-9) {
      std::erase(active, worst);
      continue;
    }
    VectorXd after = c.values + c.gradients * step.d;
    for (const Index i : active) after(i) = 0;
    if (after.maxCoeff(&worst) <= feasibility_tolerance) break;
    active.push_back(worst);
  }
  return step;
}

/// Whether all inequalities have derivatives, except for those far from being active, of which a
/// linear model without a slope is made: those of deviations at the edge of what can be released.
bool has_derivatives(Inequalities& c) {
  constexpr double far = 1e-3;
  for (std::size_t f = 0; f < c.hessians.size(); ++f) {
    const auto row = static_cast<Index>(f);
    if (c.gradients.row(row).allFinite() && c.hessians[f].allFinite()) continue;
    if (!(c.values(row) < -far)) return false;
    c.gradients.row(row).setZero();
    c.hessians[f].setZero();
  }
  return c.values.allFinite();
}

/// The inequalities at a point, with derivatives good enough for a step of about this length;
/// nothing if they have none. `last` is the model of a point so far away: after a short step, its
/// second derivatives still serve, where others are expensive.
std::optional<Inequalities> model(const NonlinearProgram& program, const VectorXd& x, double length,
                                  const std::optional<Inequalities>& last = std::nullopt) {
  constexpr double close = 1e-4;
  if (length > close && !program.is_at_kink)
    if (auto c = inequalities(program, x, quick_steps); has_derivatives(c)) {
      c.is_quick = true;
      return c;
    }
  if (length <= close && last && program.cheap_variables < program.variables())
    if (auto c = inequalities(program, x, accurate_steps, last->hessians); has_derivatives(c))
      return c;
  auto c = inequalities(program, x, accurate_steps);
  return has_derivatives(c) ? std::optional(c) : std::nullopt;
}

/// The inequalities that a small change of x may make active.
std::vector<Index> nearly_active(const NonlinearProgram& program, const Inequalities& c) {
  constexpr double near = 1e-3;
  const Index n = program.variables(), bounds = c.values.size() - 2 * n;
  std::vector<Index> active;
  for (Index i = 0; i < c.values.size(); ++i) {
    double reach = i < program.objectives ? 0 : near * c.gradients.row(i).norm();
    if (i >= bounds)  // not both ends of a short interval
      reach *= std::min(1.0, (program.upper - program.lower)((i - bounds) % n));
    if (c.values(i) >= -reach) active.push_back(i);
  }
  return active;
}

/// Multipliers without those of an earlier step: of a step along the projected gradient, which are
/// exact at a solution. Changes the active set to that of this step.
VectorXd first_multipliers(Inequalities c, std::vector<Index>& active) {
  constexpr double curvature = 100;  // steps of about a hundredth
  const Index n = c.gradients.cols() - 1;
  const auto objective = static_cast<std::size_t>(active.front());
  for (MatrixXd& hessian : c.hessians) hessian.setZero(n, n);
  c.hessians[objective] = curvature * MatrixXd::Identity(n, n);
  const VectorXd one = VectorXd::Unit(c.values.size(), active.front());
  return step_with_active_set(c, one, active).multipliers;
}

/// Whether one of the points before is better in both the objective and the violation: the filter
/// of Fletcher and Leyffer (Mathematical Programming 91, 2002).
bool is_dominated(const Point& point, const std::vector<Point>& before) {
  constexpr double max_loss = 1e-8;
  return std::ranges::any_of(before, [&](const Point& p) {
    return (is_feasible(p) || p.violation <= point.violation) &&
           p.objective - point.objective > max_loss * std::abs(point.objective);
  });
}

}  // namespace

KktPoint solve_kkt(const NonlinearProgram& program, const Point& start) {
  constexpr int max_iterations = 60;
  constexpr double enough = 1e-11, converged = 1e-7;  // lengths of the last step
  constexpr double max_residual = 1e-6, max_reach = 0.05, min_reach = 1e-8;
  const Index n = program.variables();
  KktPoint solution{start, VectorXd::Zero(program.constraints + 2 * n), false};
  double reach = max_reach;  // the longest step allowed
  std::optional<Inequalities> c = model(program, start.x, reach);
  if (!c) return solution;
  std::vector<Index> active = nearly_active(program, *c);
  VectorXd multipliers = program.is_at_kink ? first_multipliers(*c, active)
                                            : VectorXd::Unit(c->values.size(), active.front());
  double last_length = HUGE_VAL;
  std::vector<Point> visited{start};
  const double max_violation = std::max(start.violation, 0.01);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Step step = step_with_active_set(*c, multipliers, active);
    multipliers = step.multipliers;  // better ones also where the step is refused
    const VectorXd d = step.d.head(n);
    const double length = d.norm();
    // Where only steps far shorter than the model's do not lead away, the model does not hold.
    if (!std::isfinite(length) || reach < std::min(length, min_reach)) return solution;
    VectorXd x = solution.point.x + d * std::min(1.0, reach / length);
    x = x.cwiseMax(program.lower).cwiseMin(program.upper);
    const Point point = point_of(program, x, program.functions(x).col(0));
    if (point.violation > max_violation || is_dominated(point, visited)) {
      if (c->is_quick) {  // which may be to blame
        c = model(program, solution.point.x, 0);
        if (!c) return solution;
      } else {
        reach = std::min(reach, length) / 4;
      }
      continue;
    }
    reach = std::min(2 * reach, max_reach);
    visited.push_back(point);
    solution = {point, multipliers.tail(solution.multipliers.size()),
                length < converged && step.residual < max_residual,
                multipliers.head(program.objectives)};
    const bool is_rounding = length < converged && length > last_length / 2;
    if (length < enough || is_rounding) break;
    const bool is_fast = length < last_length / 10;
    last_length = length;
    c = model(program, x, length, is_fast ? c : std::nullopt);
    if (!c) {
      solution.converged = false;
      break;
    }
  }
  return solution;
}

}  // namespace trebsweep
