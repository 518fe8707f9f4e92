#include "trebsweep/optimum/local_search.hpp"

#include <cmath>

#include "trebsweep/optimum/sobol.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double lattice_spacing = 1e-3;

/// The points of a cubic lattice around the origin, with `reach` points to each side of it; in more
/// than three dimensions, some points of the cube with few values of the variables that are not
/// cheap.
MatrixXd cube(const NonlinearProgram& program, Index reach) {
  const Index n = program.variables(), width = 2 * reach + 1;
  if (reach == 0) return VectorXd::Zero(n);
  if (n <= 3) {
    MatrixXd points(n, std::lround(std::pow(width, n)));
    for (Index p = 0; p < points.cols(); ++p)
      for (Index i = 0, rest = p; i < n; ++i, rest /= width)
        points(i, p) = static_cast<double>(rest % width - reach);
    return points;
  }
  constexpr Index together = 24;
  const Index cheap = program.cheap_variables, dear = n - cheap, groups = 4 * (dear + 1);
  const auto sequence_of = [&](Index dimensions) {
    const VectorXd ends = VectorXd::Constant(dimensions, static_cast<double>(reach));
    return SobolSequence(-ends, ends);
  };
  MatrixXd points(n, groups * together);
  points.topRows(cheap) = sequence_of(cheap).next(points.cols());
  const MatrixXd of_dear = sequence_of(dear).next(groups);
  for (Index p = 0; p < points.cols(); ++p) points.col(p).tail(dear) = of_dear.col(p / together);
  return points;
}

/// The best point of a cube() around a point.
Point best_around(const NonlinearProgram& program, const Point& centre, double spacing,
                  Index reach) {
  MatrixXd points = spacing * cube(program, reach);
  for (auto point : points.colwise())
    point = (point + centre.x).cwiseMax(program.lower).cwiseMin(program.upper);
  const MatrixXd values = program.functions(points);
  Point best = centre;
  for (Index p = 0; p < points.cols(); ++p) {
    const Point point = point_of(program, points.col(p), values.col(p));
    if (is_better(point, best)) best = point;
  }
  return best;
}

/// Whether a is better than b by more than a part of its objective.
bool is_better_by(double part, const Point& a, const Point& b) {
  if (!is_feasible(a) || !is_feasible(b)) return is_better(a, b);
  return a.objective - b.objective > part * std::abs(b.objective);
}

/// Whether a is better than b by more than violations within feasibility_tolerance may gain.
bool is_clearly_better(const Point& a, const Point& b) { return is_better_by(1e-8, a, b); }

/// The best point of finer and finer lattices: for functions with a kink at the optimum, and for
/// starts that violate the constraints.
Point zoom(const NonlinearProgram& program, Point point) {
  constexpr double noise = 1e-11, finest = 1e-9;
  constexpr int max_steps = 40;
  constexpr Index reach = 2;
  double spacing = 1e-2;
  for (int step = 0; step < max_steps && spacing > finest; ++step) {
    const Point best = best_around(program, point, spacing, reach);
    if (is_better_by(noise, best, point))
      point = best;
    else
      spacing /= 3;
  }
  return point;
}

/// A point close to x at which all functions have values, or x itself if none is found.
Point point_with_values(const NonlinearProgram& program, const VectorXd& x) {
  constexpr double farthest = 0.1;
  Point point{x, 0, HUGE_VAL};
  point = best_around(program, point, 0, 0);
  for (double far = 0.01; std::isinf(point.violation) && far <= farthest; far *= 2)
    point = best_around(program, point, far, 2);
  return point;
}

/// Newton's solution from a point; if the method fails or leads away, the best point known.
KktPoint polished(const NonlinearProgram& program, const Point& near) {
  const KktPoint found = solve_kkt(program, near);
  if (found.converged && !is_clearly_better(near, found.point)) return found;
  return {is_better(found.point, near) ? found.point : near,
          VectorXd::Zero(program.constraints + 2 * program.variables()), false};
}

KktPoint search_once(const NonlinearProgram& program, const Point& start, Effort effort) {
  const bool near = start.violation <= little_violation;
  const KktPoint found = polished(program, near ? start : zoom(program, start));
  if (found.converged || !near || effort == Effort::quick) return found;
  return polished(program, zoom(program, found.point));
}

}  // namespace

KktPoint search(const NonlinearProgram& program, const VectorXd& x, Effort effort) {
  constexpr int max_searches = 4;
  Point start = point_with_values(program, x);
  if (program.variables() == 0) return {start, VectorXd::Zero(program.constraints), true};
  KktPoint best = search_once(program, start, effort);
  for (int searches = 1; effort == Effort::thorough && searches < max_searches; ++searches) {
    start = best_around(program, best.point, lattice_spacing, 3);
    if (!is_clearly_better(start, best.point)) break;
    const KktPoint found = search_once(program, start, effort);
    if (is_better(found.point, best.point)) best = found;
  }
  return best;
}

}  // namespace trebsweep
