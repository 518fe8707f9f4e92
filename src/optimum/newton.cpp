#include "trebsweep/optimum/newton.hpp"

#include <Eigen/Cholesky>
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

/// A step of y, the multipliers of all inequalities, and the residual of the equations that it
/// solves or the largest of the linearized inequalities after it.
struct Step {
  VectorXd d, multipliers;
  double residual;
};

/// A symmetric matrix whose eigenvalues in the space of some orthonormal columns are at most
/// `-least` there: positive ones change their signs.
MatrixXd concave_within(const MatrixXd& symmetric, const MatrixXd& space, double least) {
  if (space.cols() == 0) return symmetric;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> reduced(space.transpose() * symmetric * space);
  const VectorXd change =
      reduced.eigenvalues().unaryExpr([&](double e) { return std::min(-std::abs(e), -least) - e; });
  const MatrixXd directions = space * reduced.eigenvectors();
  return symmetric + directions * change.asDiagonal() * directions.transpose();
}

/// The second derivatives of the Lagrangian.
MatrixXd lagrangian_hessian(const Inequalities& c, const VectorXd& multipliers) {
  const Index n = c.gradients.cols() - 1;
  MatrixXd hessian = MatrixXd::Zero(n, n);
  for (std::size_t f = 0; f < c.hessians.size(); ++f)
    hessian -= multipliers(static_cast<Index>(f)) * c.hessians[f];
  return hessian;
}

/// Orthonormal directions of x along which the active inequalities do not change; none at a vertex.
MatrixXd tangents(const Inequalities& c, const std::vector<Index>& active) {
  const Index n = c.gradients.cols() - 1;
  const Eigen::FullPivLU<MatrixXd> factors(c.gradients(active, Eigen::all));
  if (factors.dimensionOfKernel() == 0) return MatrixXd(n, 0);
  const MatrixXd kernel = factors.kernel().topRows(n);
  return kernel.householderQr().householderQ() * MatrixXd::Identity(n, kernel.cols());
}

/// The x >= 0 that minimizes x' A x / 2 - b' x, with A positive definite: the active-set method of
/// Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23).
VectorXd non_negative_minimum(const MatrixXd& a, const VectorXd& b) {
  constexpr double rounding = 1e-12;
  VectorXd x = VectorXd::Zero(b.size());
  std::vector<Index> positive;
  for (Index changes = 0; changes < 10 * b.size(); ++changes) {
    VectorXd slope = b - a * x;
    for (const Index i : positive) slope(i) = 0;
    Index steepest = 0;
    if (slope.maxCoeff(&steepest) <= rounding) break;
    positive.push_back(steepest);
    while (!positive.empty()) {
      const VectorXd full = a(positive, positive).ldlt().solve(b(positive, 0));
      if (full.minCoeff() > 0) {
        x(positive, 0) = full;
        break;
      }
      double part = 1;  // of the way to where the first of them becomes zero
      Index first = 0;
      for (Index k = 0; k < full.size(); ++k)
        if (const double now = x(positive[static_cast<std::size_t>(k)]); full(k) <= 0)
          if (const double p = now > 0 ? now / (now - full(k)) : 0; p <= part) part = p, first = k;
      x(positive, 0) += part * (full - x(positive, 0));
      x(positive[static_cast<std::size_t>(first)]) = 0;
      positive.erase(positive.begin() + first);
    }
  }
  return x;
}

/// The step to the maximum of a concave quadratic model of t, subject to the linearized
/// inequalities: by its dual problem. A small penalty for multipliers admits violations, where no
/// step satisfies all inequalities.
Step concave_step(const Inequalities& c, const MatrixXd& hessian) {
  constexpr double curvature_of_t = 1e-3, penalty = 1e-12;
  const Index n = hessian.cols();
  MatrixXd model = MatrixXd::Zero(n + 1, n + 1);
  model.topLeftCorner(n, n) = -hessian;
  model(n, n) = curvature_of_t;
  const Eigen::LDLT<MatrixXd> factors(model);
  const VectorXd ascent = VectorXd::Unit(n + 1, n);  // the gradient of t
  MatrixXd dual = c.gradients * factors.solve(c.gradients.transpose());
  dual.diagonal().array() += penalty * dual.diagonal().maxCoeff();
  const VectorXd multipliers =
      non_negative_minimum(dual, c.gradients * factors.solve(ascent) + c.values);
  const VectorXd d = factors.solve(ascent - c.gradients.transpose() * multipliers);
  return {d, multipliers, std::max(0.0, (c.values + c.gradients * d).maxCoeff())};
}

/// The step to the stationary point of a quadratic model on the linearized active set.
Step equality_step(const Inequalities& c, const MatrixXd& hessian,
                   const std::vector<Index>& active) {
  const Index n = c.gradients.cols(), m = std::ssize(active);
  MatrixXd kkt = MatrixXd::Zero(n + m, n + m);
  kkt.topLeftCorner(n - 1, n - 1) = hessian;
  kkt.bottomLeftCorner(m, n) = c.gradients(active, Eigen::all);
  kkt.topRightCorner(n, m) = -c.gradients(active, Eigen::all).transpose();
  VectorXd right = VectorXd::Zero(n + m);
  right(n - 1) = -1;  // the gradient of t
  right.tail(m) = -c.values(active, 0);
  const VectorXd solution = kkt.fullPivLu().solve(right);
  Step step{solution.head(n), VectorXd::Zero(c.values.size()), (kkt * solution - right).norm()};
  step.multipliers(active, 0) = solution.tail(m);
  return step;
}

/// The step to the maximum of the Lagrangian's quadratic model, subject to the linearized
/// inequalities. A model that is concave in all directions gives the active set. In the tangent
/// space of that, the Lagrangian is mostly concave at a maximum, and the step is Newton's.
/// `multipliers` are those of the last step.
Step newton_step(const Inequalities& c, const VectorXd& multipliers) {
  constexpr double flat = 1e-4, rounding = 1e-9;
  const Index n = c.gradients.cols() - 1;
  const MatrixXd hessian = lagrangian_hessian(c, multipliers);
  const Step concave = concave_step(
      c, concave_within(hessian, MatrixXd::Identity(n, n), flat * std::max(1.0, hessian.norm())));
  std::vector<Index> active;
  for (Index i = 0; i < c.values.size(); ++i)
    if (concave.multipliers(i) > 0) active.push_back(i);
  Step step = equality_step(c, concave_within(hessian, tangents(c, active), 0), active);
  // Where more inequalities are active than there are dimensions, some multipliers are not needed.
  for (Index least = 0; step.multipliers.minCoeff(&least) <= -rounding && active.size() > 1;) {
    std::erase(active, least);
    step = equality_step(c, concave_within(hessian, tangents(c, active), 0), active);
  }
  const bool is_exact = step.residual < rounding && step.multipliers.minCoeff() > -rounding &&
                        (c.values + c.gradients * step.d).maxCoeff() < rounding;
  return is_exact ? step : concave;
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

/// Multipliers without those of an earlier step: of a step along the projected gradient, which are
/// exact at a solution.
VectorXd first_multipliers(Inequalities c, Index objective) {
  constexpr double curvature = 100;  // steps of about a hundredth
  const Index n = c.gradients.cols() - 1;
  for (MatrixXd& hessian : c.hessians) hessian.setZero(n, n);
  const VectorXd one = VectorXd::Unit(c.values.size(), objective);
  c.hessians[static_cast<std::size_t>(objective)] = curvature * MatrixXd::Identity(n, n);
  return newton_step(c, one).multipliers;
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

constexpr double converged = 1e-7;  // the length of the last step
constexpr double max_residual = 1e-6, max_reach = 0.05;

/// The state of Newton's method.
struct Iterate {
  KktPoint solution;
  std::optional<Inequalities> c;  // at the solution
  VectorXd multipliers;           // of all inequalities
  std::vector<Point> visited;
  double max_violation;
  double reach = max_reach;  // the longest step allowed
  double last_length = HUGE_VAL;
};

/// After a step that leads away: takes better derivatives or, if these are not to blame, a shorter
/// reach. Returns whether another step is possible.
bool retry(const NonlinearProgram& program, double length, Iterate& now) {
  if (now.c->is_quick) {
    now.c = model(program, now.solution.point.x, 0);
    return now.c.has_value();
  }
  now.reach = std::min(now.reach, length) / 4;
  if (length >= converged) now.solution.converged = false;
  return true;
}

/// Goes to the end of a step. Returns whether another one is possible and worth while.
bool accept(const NonlinearProgram& program, const Step& step, double length, const Point& point,
            Iterate& now) {
  constexpr double enough = 1e-11;
  now.reach = std::min(2 * now.reach, max_reach);
  now.visited.push_back(point);
  now.solution = {point, now.multipliers.tail(now.solution.multipliers.size()),
                  length < converged && step.residual < max_residual && is_feasible(point),
                  now.multipliers.head(program.objectives)};
  const bool is_rounding = length < converged && length > now.last_length / 2;
  if (length < enough || is_rounding) return false;
  const bool is_fast = length < now.last_length / 10;
  now.last_length = length;
  now.c = model(program, point.x, length, is_fast ? now.c : std::nullopt);
  if (!now.c) now.solution.converged = false;
  return now.c.has_value();
}

/// Makes one step, if it does not lead away. Returns whether another one may follow.
bool iterate(const NonlinearProgram& program, Iterate& now) {
  constexpr double min_reach = 1e-8;
  const Step step = newton_step(*now.c, now.multipliers);
  // Better ones also where the step is refused, unless the inequalities exclude each other.
  if (step.residual < max_residual) now.multipliers = step.multipliers;
  const VectorXd d = step.d.head(program.variables());
  const double length = d.norm();
  // Where only steps far shorter than the model's do not lead away, the model does not hold.
  if (!std::isfinite(length) || now.reach < std::min(length, min_reach)) return false;
  VectorXd x = now.solution.point.x + d * std::min(1.0, now.reach / length);
  x = x.cwiseMax(program.lower).cwiseMin(program.upper);
  const Point point = point_of(program, x, program.functions(x).col(0));
  if (point.violation > now.max_violation || is_dominated(point, now.visited))
    return retry(program, length, now);
  return accept(program, step, length, point, now);
}

}  // namespace

KktPoint solve_kkt(const NonlinearProgram& program, const Point& start) {
  constexpr int max_iterations = 60;
  const Index n = program.variables();
  Iterate now{.solution = {start, VectorXd::Zero(program.constraints + 2 * n), false},
              .c = model(program, start.x, max_reach),
              .multipliers = {},
              .visited = {start},
              .max_violation = std::max(start.violation, little_violation)};
  if (!now.c) return now.solution;
  Index smallest = 0;  // of the objectives
  now.c->values.head(program.objectives).maxCoeff(&smallest);
  now.multipliers = program.is_at_kink ? first_multipliers(*now.c, smallest)
                                       : VectorXd::Unit(now.c->values.size(), smallest);
  for (int i = 0; i < max_iterations; ++i)
    if (!iterate(program, now)) break;
  // Where the method has not converged, the last point is not always the best.
  if (!now.solution.converged)
    now.solution.point = *std::ranges::max_element(
        now.visited, [](const Point& a, const Point& b) { return is_better(b, a); });
  return now.solution;
}

}  // namespace trebsweep
