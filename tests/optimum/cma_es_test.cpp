#include "trebsweep/optimum/cma_es.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "optimum/programs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using Eigen::VectorXd;

namespace {

Point evolved(const NonlinearProgram& program, const VectorXd& start) {
  return evolve(program, start, (program.upper - program.lower) / 10);
}

}  // namespace

TEST_CASE("Evolution ends next to Hock and Schittkowski's solutions, with active constraints") {
  for (const SolvedProgram& solved : hock_schittkowski()) {
    INFO(solved.name);
    const Point found = evolved(solved.program, solved.start);
    CHECK(is_feasible(found));
    CHECK(found.objective <= solved.objective + 1e-12);
    CHECK(found.objective == Approx(solved.objective).epsilon(2e-3));
  }
}

TEST_CASE("Evolution ends next to Charalambous and Conn's minimax solutions, at kinks") {
  for (const SolvedProgram& solved : minimax()) {
    INFO(solved.name);
    const Point found = evolved(solved.program, solved.start);
    CHECK((found.x - solved.solution).cwiseAbs().maxCoeff() < 5e-3);
    CHECK(found.objective == Approx(solved.objective).epsilon(1e-3));
  }
}

TEST_CASE("Evolution follows Rosenbrock's curved valley") {
  const auto values = [](const VectorXd& x) {
    const double a = 1 - x(0), b = x(1) - x(0) * x(0);
    return std::vector{-a * a - 100 * b * b};
  };
  const Point found = evolved(program_of(values, 1, 0, {-2, -2}, {2, 2}), vector({-1.2, 1}));
  CHECK((found.x - vector({1, 1})).norm() < 0.01);
}

TEST_CASE("Evolution climbs to a jump, and past points without values") {
  // Up to x + y = 1, and without values in a strip on the way.
  const auto values = [](const VectorXd& x) {
    const double sum = x(0) + x(1);
    if (sum > 0.6 && sum < 0.65) return std::vector{std::nan("")};
    return std::vector{sum <= 1 ? sum - std::pow(x(0) - x(1), 2) : -1};
  };
  const Point found = evolved(program_of(values, 1, 0, {0, 0}, {1, 1}), vector({0.2, 0.3}));
  CHECK(found.objective <= 1);
  CHECK(found.objective > 0.995);
}

TEST_CASE("Evolution from a start that violates the constraints ends at one that does not") {
  const auto values = [](const VectorXd& x) {
    return std::vector{x(0), (x - vector({0.7, 0.7, 0.7})).norm() - 0.1};
  };
  const NonlinearProgram program = program_of(values, 1, 1, {0, 0, 0}, {1, 1, 1});
  const Point found = evolved(program, vector({0.1, 0.2, 0.1}));
  CHECK(is_feasible(found));
  CHECK(found.objective == Approx(0.8).epsilon(2e-3));
}

TEST_CASE("Evolution samples expensive variables less often, and ends at the same point") {
  const auto values = [](const VectorXd& x) {
    return std::vector{-(x - vector({0.3, 0.4, 0.5, 0.6})).squaredNorm() -
                       std::pow(x(0) - x(3), 2)};
  };
  NonlinearProgram program = program_of(values, 1, 0, {0, 0, 0, 0}, {1, 1, 1, 1});
  program.cheap_variables = 2;
  const auto functions = program.functions;
  std::size_t most = 0;
  program.functions = [&](const Eigen::MatrixXd& points) {
    std::size_t distinct = 1;
    for (Eigen::Index p = 1; p < points.cols(); ++p)
      distinct += points.col(p).tail(2) != points.col(p - 1).tail(2);
    if (points.cols() > 1) {
      CHECK(8 * distinct <= static_cast<std::size_t>(points.cols()));
      CHECK(points.col(2).head(2) != points.col(3).head(2));
    }
    most = std::max(most, distinct);
    return functions(points);
  };
  const Point found = evolved(program, vector({0.9, 0.1, 0.1, 0.1}));
  CHECK(most > 1);
  CHECK((found.x - vector({0.4, 0.4, 0.5, 0.5})).norm() < 0.01);
}

TEST_CASE("Evolution is bitwise reproducible, and its result within the bounds") {
  const SolvedProgram cb2 = minimax()[0];
  const Point once = evolved(cb2.program, cb2.start), again = evolved(cb2.program, cb2.start);
  CHECK(once.x == again.x);
  const auto slope = [](const VectorXd& x) { return std::vector{x(0) - x(1)}; };
  const Point corner = evolved(program_of(slope, 1, 0, {0, 0}, {1, 1}), vector({0.5, 0.5}));
  CHECK(corner.x(0) == 1);
  CHECK(corner.x(1) == 0);
}

TEST_CASE("Evolution of expensive variables alone takes distinct samples") {
  NonlinearProgram program = program_of(
      [](const VectorXd& x) { return std::vector{-std::abs(x(0) - 0.3)}; }, 1, 0, {0}, {1});
  program.cheap_variables = 0;
  const auto functions = program.functions;
  program.functions = [&](const Eigen::MatrixXd& points) {
    if (points.cols() > 1) CHECK(points(0, 0) != points(0, 1));
    return functions(points);
  };
  CHECK(evolved(program, vector({0.9})).x(0) == Approx(0.3).margin(3e-3));
}

TEST_CASE("Evolution without a spread stays at its start") {
  const auto slope = [](const VectorXd& x) { return std::vector{x(0)}; };
  const Point found =
      evolve(program_of(slope, 1, 0, {0, 0}, {1, 1}), vector({0.5, 0.4}), vector({0.1, 0}));
  CHECK(found.x == vector({0.5, 0.4}));
}
