#include "trebsweep/optimum/newton.hpp"

#include "optimum/programs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using Eigen::VectorXd;

namespace {

Point at(const NonlinearProgram& program, const VectorXd& x) {
  return point_of(program, x, program.functions(x).col(0));
}

/// solve_kkt() from a point next to the solution, inside the bounds.
KktPoint solve_near(const SolvedProgram& solved) {
  VectorXd x = solved.solution;
  for (Eigen::Index i = 0; i < x.size(); ++i) x(i) += i % 2 == 0 ? 3e-4 : -2e-4;
  const NonlinearProgram& program = solved.program;
  return solve_kkt(program, at(program, x.cwiseMax(program.lower).cwiseMin(program.upper)));
}

}  // namespace

TEST_CASE("Solutions and multipliers are those of Hock and Schittkowski, to rounding errors") {
  for (const SolvedProgram& solved : hock_schittkowski()) {
    INFO(solved.name);
    const KktPoint found = solve_near(solved);
    CHECK(found.converged);
    CHECK(is_feasible(found.point));
    CHECK((found.point.x - solved.solution).cwiseAbs().maxCoeff() < 1e-10);
    CHECK(std::abs(found.point.objective - solved.objective) < 1e-10);
    CHECK((found.multipliers - solved.multipliers).cwiseAbs().maxCoeff() < 1e-8);
  }
}

TEST_CASE("Multipliers of inactive inequalities are exactly zero") {
  for (const SolvedProgram& solved : hock_schittkowski()) {
    const KktPoint found = solve_near(solved);
    for (Eigen::Index i = 0; i < found.multipliers.size(); ++i)
      CHECK((found.multipliers(i) == 0) == (solved.multipliers(i) == 0));
  }
}

TEST_CASE("The largest of the smallest of several functions is found where they meet") {
  for (const SolvedProgram& solved : minimax()) {
    INFO(solved.name);
    const KktPoint found = solve_near(solved);
    CHECK(found.converged);
    CHECK((found.point.x - solved.solution).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(std::abs(found.point.objective - solved.objective) < 1e-9);
  }
}

TEST_CASE("At a kink, the weights of the functions that meet add up to one") {
  for (SolvedProgram& solved : minimax()) {
    INFO(solved.name);
    solved.program.is_at_kink = true;
    const KktPoint found = solve_near(solved);
    CHECK(found.converged);
    CHECK((found.point.x - solved.solution).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(found.weights.sum() == Approx(1));
    CHECK(found.weights.minCoeff() > -1e-9);
  }
}

TEST_CASE("At a vertex with more constraints than dimensions, the solution is exact and feasible") {
  const auto program = program_of(
      [](const VectorXd& x) {
        return std::vector{2.016 * x(0) + 1.963 * x(1), 1.705 * (x(0) - 0.5), 7.318 * (x(1) - 0.5),
                           3.989 * (x(0) + x(1) - 1)};
      },
      1, 3, {0, 0}, {1, 1});
  const KktPoint found = solve_kkt(program, at(program, vector({0.48, 0.49})));
  CHECK(found.converged);
  CHECK(is_feasible(found.point));
  CHECK((found.point.x - vector({0.5, 0.5})).norm() < 1e-10);
}

TEST_CASE("A Lagrangian that is convex across the constraints is maximized along them") {
  // x y on x + y <= 1: its second derivatives have an eigenvalue of either sign.
  const auto program = program_of(
      [](const VectorXd& x) {
        return std::vector{x(0) * x(1), x(0) + x(1) - 1};
      },
      1, 1, {0, 0}, {1, 1});
  const KktPoint found = solve_kkt(program, at(program, vector({0.42, 0.5})));
  CHECK(found.converged);
  CHECK((found.point.x - vector({0.5, 0.5})).norm() < 1e-9);
  CHECK(found.multipliers(0) == Approx(0.5));
}

TEST_CASE("Steps that would lead away are refused") {
  // Newton's method for the maximum of -(1 + x^2)^(1/2) diverges from beyond 1.
  const auto program =
      program_of([](const VectorXd& x) { return std::vector{-std::sqrt(1 + 100 * x(0) * x(0))}; },
                 1, 0, {-2}, {2});
  const KktPoint found = solve_kkt(program, at(program, vector({0.5})));
  CHECK(found.converged);
  CHECK(std::abs(found.point.x(0)) < 1e-9);
}

TEST_CASE("A method that does not converge returns the best point on its way") {
  const auto program = program_of(
      [](const VectorXd& x) {
        const double far = x(0) - 0.1234567;
        return std::vector{std::min(far, -2 * far)};
      },
      1, 0, {0}, {1});
  const Point start = at(program, vector({0.5}));
  const KktPoint found = solve_kkt(program, start);
  CHECK_FALSE(found.converged);
  CHECK(found.point.objective > start.objective / 10);
}

TEST_CASE("A constraint that is given twice has its multiplier shared") {
  SolvedProgram solved = hock_schittkowski()[1];
  const NonlinearProgram once = solved.program;
  solved.program.functions = [once](const Eigen::MatrixXd& points) {
    const Eigen::MatrixXd values = once.functions(points);
    Eigen::MatrixXd twice(3, points.cols());
    twice << values, values.row(1);
    return twice;
  };
  solved.program.constraints = 2;
  const KktPoint found = solve_near(solved);
  CHECK(found.converged);
  CHECK((found.point.x - solved.solution).cwiseAbs().maxCoeff() < 1e-9);
  CHECK(found.multipliers.head(2).sum() == Approx(2 / 9.));
}

TEST_CASE("The optimum changes by its multipliers as constraints and bounds are relaxed") {
  for (const SolvedProgram& solved : hock_schittkowski())
    for (Eigen::Index i = 0; i < solved.multipliers.size(); ++i) {
      if (solved.multipliers(i) == 0) continue;
      const auto optimum = [&](double by) {
        SolvedProgram relaxed = solved;
        const Eigen::Index c = i - solved.program.constraints;
        if (c >= 0)
          relaxed.program.lower(c) -= by;  // upper bounds are not active
        else
          relaxed.program.functions = [f = solved.program.functions, i, by](const auto& points) {
            Eigen::MatrixXd values = f(points);
            values.row(i + 1).array() -= by;
            return values;
          };
        return solve_near(relaxed).point.objective;
      };
      INFO(solved.name << ", " << i);
      CHECK((optimum(1e-4) - optimum(-1e-4)) / 2e-4 == Approx(solved.multipliers(i)).epsilon(1e-6));
    }
}

TEST_CASE("A function without derivatives counts only where it may be active") {
  // The first solution is at x = 1, where sqrt(1 - x) has no derivative.
  const auto solved_with = [](double height) {
    return program_of(
        [height](const VectorXd& x) {
          return std::vector{x(0) - x(1) * x(1), std::sqrt(1 - x(0)) + height};
        },
        1, 1, {0, -1}, {1, 1});
  };
  const auto far = solved_with(-0.5);
  const KktPoint found = solve_kkt(far, at(far, vector({1, 0.01})));
  CHECK(found.converged);
  CHECK(found.point.x(0) == 1);
  CHECK(std::abs(found.point.x(1)) < 1e-9);
  CHECK(found.multipliers.head(1)(0) == 0);
  CHECK(found.multipliers(3) == Approx(1));  // of the upper bound of x
  const auto active = solved_with(0);
  CHECK_FALSE(solve_kkt(active, at(active, vector({1, 0.01}))).converged);
}

TEST_CASE("Newton's method does not converge without values or without a feasible point") {
  const auto no_value =
      program_of([](const VectorXd&) { return std::vector{std::nan("")}; }, 1, 0, {0}, {1});
  CHECK_FALSE(solve_kkt(no_value, {vector({0.5}), 0, HUGE_VAL}).converged);
  const auto infeasible = program_of(
      [](const VectorXd& x) {
        return std::vector{x(0), x(0) - 0.3, 0.5 - x(0)};
      },
      1, 2, {0}, {1});
  const KktPoint found = solve_kkt(infeasible, at(infeasible, vector({0.31})));
  CHECK_FALSE((found.converged && is_feasible(found.point)));
}

TEST_CASE("An objective that increases without curvature is largest at a bound") {
  const auto program = program_of([](const VectorXd& x) { return std::vector{x(0) - x(1) * x(1)}; },
                                  1, 0, {-1, -1}, {1, 1});
  const KktPoint found = solve_kkt(program, at(program, vector({0.2, 0.1})));
  CHECK(found.converged);
  CHECK(found.point.x(0) == 1);
  CHECK(found.point.x(1) == Approx(0).margin(1e-9));
  CHECK(found.multipliers(2) == Approx(1));  // of x(0) <= 1
}

TEST_CASE("Where the constraints cannot all be linearized to hold, a solution is still found") {
  // At the start, the tangent of the circle lies beyond the bound of x(1).
  const auto program = program_of(
      [](const VectorXd& x) {
        return std::vector{x(0), 0.5 - x.squaredNorm(), x(1) - 0.3 - x(0)};
      },
      1, 2, {-1, -1}, {0.9, 0.2});
  const KktPoint found = solve_kkt(program, at(program, vector({0.05, 0.19})));
  CHECK(found.converged);
  CHECK(found.point.x(0) == Approx(0.9));
}

TEST_CASE("Where the objective is convex, the solution is a vertex and not the minimum") {
  const auto values = [](const Eigen::VectorXd& x) -> std::vector<double> {
    return {x(0) * x(0) + 0.5 * x(1) * x(1) - 0.1 * x(0) * x(1)};
  };
  const NonlinearProgram program = program_of(values, 1, 0, {-1, -1}, {1.5, 1});
  const Eigen::VectorXd start = vector({0.1, -0.05});
  const KktPoint found =
      solve_kkt(program, point_of(program, start, program.functions(start).col(0)));
  CHECK(found.converged);
  CHECK(found.point.x == vector({1.5, -1}));
  CHECK(found.multipliers.minCoeff() >= 0);
}
