#include "trebsweep/optimum/local_search.hpp"

#include "optimum/programs.hpp"
#include "support/catch.hpp"

using namespace trebsweep;
using Eigen::VectorXd;

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

void check_is_found(const SolvedProgram& solved, double precision) {
  INFO(solved.name);
  const KktPoint found = search(solved.program, solved.start);
  CHECK(found.converged);
  CHECK(is_feasible(found.point));
  CHECK((found.point.x - solved.solution).cwiseAbs().maxCoeff() < precision);
  CHECK(std::abs(found.point.objective - solved.objective) < precision);
  CHECK((found.multipliers - solved.multipliers).cwiseAbs().maxCoeff() < 1e-7);
}

}  // namespace

TEST_CASE("A search from Hock and Schittkowski's starts reaches their solutions") {
  for (const SolvedProgram& solved : hock_schittkowski()) check_is_found(solved, 1e-9);
}

TEST_CASE("A search from Charalambous and Conn's starts reaches their minimax solutions") {
  for (const SolvedProgram& solved : minimax()) check_is_found(solved, 1e-9);
}

TEST_CASE("A constraint on the largest of the smallest of several functions is respected") {
  SolvedProgram cb3 = minimax()[1];  // without the constraint x = y = 1
  const auto values = [f = cb3.program.functions](const VectorXd& x) {
    const VectorXd v = f(x).col(0);
    return std::vector{v(0), v(1), v(2), x(0) - 0.8};
  };
  // There (2 - 0.8)^2 + (2 - y)^2 = 2 exp(y - 0.8).
  double low = 0, high = 2;
  while (high - low > 1e-15) {
    const double y = (low + high) / 2;
    (1.44 + std::pow(2 - y, 2) > 2 * std::exp(y - 0.8) ? low : high) = y;
  }
  for (const double start : {0.0, 1.0, 2.0}) {
    const KktPoint found = search(program_of(values, 3, 1, {-1, -1}, {4, 4}), vector({start, 2}));
    CHECK(found.converged);
    CHECK((found.point.x - vector({0.8, low})).cwiseAbs().maxCoeff() < 1e-8);
    CHECK(found.multipliers(0) > 0);
  }
}

TEST_CASE("A search is bitwise reproducible, whatever the memory held before") {
  SolvedProgram cb3 = minimax()[1];
  const auto values = [f = cb3.program.functions](const VectorXd& x) {
    const VectorXd v = f(x).col(0);
    return std::vector{v(0), v(1), v(2), x(0) - 0.8};
  };
  const auto find = [&](double remains) {
    for (std::size_t size = 1; size < 200; ++size) std::vector<double>(size, remains);
    return search(program_of(values, 3, 1, {-1, -1}, {4, 4}), vector({0.5, 0.7})).point.x;
  };
  const VectorXd first = find(0);
  for (const double remains : {1.0, -3.0, 1e3}) CHECK(find(remains) == first);
}

TEST_CASE("An optimum at a kink of a constraint is found") {
  // Where 2 x^2 + y^2 and x^2 + 2 y^2 are equal.
  const auto values = [](const VectorXd& x) {
    const double a = x(0) * x(0), b = x(1) * x(1);
    return std::vector{x(0) + x(1), std::max(2 * a + b, a + 2 * b) - 3};
  };
  for (const auto& start : {vector({0.5, 0.5}), vector({0.7, 1.5}), vector({1.2, 0.2})}) {
    const KktPoint found = search(program_of(values, 1, 1, {0, 0}, {2, 2}), start);
    CHECK(is_feasible(found.point));
    CHECK((found.point.x - vector({1, 1})).cwiseAbs().maxCoeff() < 1e-6);
    CHECK(found.point.objective == Approx(2).epsilon(1e-8));
  }
}

TEST_CASE("An optimum at a kink of the objective is found") {
  const auto values = [](const VectorXd& x) {
    return std::vector{-std::abs(x(0) - 0.6) - std::pow(x(1) - 0.4, 2)};
  };
  const KktPoint found = search(program_of(values, 1, 0, {0, 0}, {1, 1}), vector({0.2, 0.8}));
  CHECK(found.point.x(0) == Approx(0.6).margin(1e-8));
  CHECK(found.point.x(1) == Approx(0.4).margin(1e-4));
}

TEST_CASE("A search may start at a point without a value, and pass others") {
  const auto values = [](const VectorXd& x) {
    const double distance = x(0) - 0.5;
    return std::vector{distance > 0 ? std::log(distance) - distance : undefined};
  };
  for (const double start : {0.46, 0.499, 0.51, 1.9}) {
    INFO(start);
    const KktPoint found = search(program_of(values, 1, 0, {0}, {2}), vector({start}));
    CHECK(found.converged);
    CHECK(found.point.x(0) == Approx(1.5).epsilon(1e-9));
    CHECK(found.point.objective == Approx(-1).epsilon(1e-12));
  }
}

TEST_CASE("An optimum next to points without a value is found") {
  // The larger x, the better, up to 0.7; beyond that there is no value.
  const auto values = [](const VectorXd& x) {
    return std::vector{x(0) <= 0.7 ? x(0) - std::pow(x(1) - 0.3, 2) : undefined};
  };
  const KktPoint found = search(program_of(values, 1, 0, {0, 0}, {1, 1}), vector({0.3, 0.5}));
  CHECK(is_feasible(found.point));
  CHECK(found.point.x(0) == Approx(0.7).margin(1e-8));
  CHECK(found.point.x(1) == Approx(0.3).margin(1e-4));
}

TEST_CASE("Where there is no value at all, the result is infeasible") {
  const auto program =
      program_of([](const VectorXd&) { return std::vector{undefined}; }, 1, 0, {0}, {1});
  CHECK(std::isinf(search(program, vector({0.5})).point.violation));
}

TEST_CASE("Without variables the start is the result") {
  for (const double constraint : {-1.0, 0.25}) {
    const auto values = [=](const VectorXd&) { return std::vector{3.0, constraint}; };
    const KktPoint found = search(program_of(values, 1, 1, {}, {}), VectorXd(0));
    CHECK(found.point.x.size() == 0);
    CHECK(found.point.objective == 3);
    CHECK(found.point.violation == std::max(constraint, 0.0));
    CHECK(found.multipliers.size() == 1);
    CHECK(found.multipliers(0) == 0);
  }
}

TEST_CASE("Without a feasible point, that with the smallest violation is the result") {
  const auto line = [](const VectorXd& x) { return std::vector{x(0), x(0) - 0.3, 0.5 - x(0)}; };
  const KktPoint between = search(program_of(line, 1, 2, {0}, {1}), vector({0.9}));
  CHECK_FALSE(is_feasible(between.point));
  CHECK(between.point.violation == Approx(0.1).epsilon(1e-6));
  const auto bowl = [](const VectorXd& x) {
    return std::vector{x(0) + x(1), 0.2 + (x - vector({0.3, 0.6})).squaredNorm()};
  };
  const KktPoint bottom = search(program_of(bowl, 1, 1, {0, 0}, {1, 1}), vector({0.9, 0.1}));
  CHECK(bottom.point.violation == Approx(0.2).epsilon(1e-6));
}

TEST_CASE("From a saddle, a search goes on to a maximum") {
  const auto values = [](const VectorXd& x) {
    const double u = x(0) - 0.5, v = x(1) - 0.5;
    return std::vector{u * u - std::pow(u, 4) * 8 - v * v};
  };
  const KktPoint found = search(program_of(values, 1, 0, {0, 0}, {1, 1}), vector({0.5, 0.5}));
  CHECK(std::abs(found.point.x(0) - 0.5) == Approx(0.25).epsilon(1e-8));
  CHECK(found.point.objective == Approx(1 / 32.).epsilon(1e-10));
}
