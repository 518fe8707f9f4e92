#include "trebsweep/optimum/derivatives.hpp"

#include <cmath>
#include <numbers>

#include "support/catch.hpp"

using namespace trebsweep;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// exp(x + 2 y) sin(3 z) and x log(y) / z.
VectorXd values(const Vector3d& p) {
  VectorXd v(2);
  v << std::exp(p(0) + 2 * p(1)) * std::sin(3 * p(2)), p(0) * std::log(p(1)) / p(2);
  return v;
}

MatrixXd gradients(const Vector3d& p) {
  const double e = std::exp(p(0) + 2 * p(1)), s = std::sin(3 * p(2)), c = std::cos(3 * p(2));
  const double x = p(0), y = p(1), z = p(2), l = std::log(y);
  MatrixXd g(2, 3);
  g << e * s, 2 * e * s, 3 * e * c, l / z, x / y / z, -x * l / z / z;
  return g;
}

MatrixXd hessian_of_first(const Vector3d& p) {
  const double e = std::exp(p(0) + 2 * p(1)), s = std::sin(3 * p(2)), c = std::cos(3 * p(2));
  MatrixXd h(3, 3);
  h << e * s, 2 * e * s, 3 * e * c, 2 * e * s, 4 * e * s, 6 * e * c, 3 * e * c, 6 * e * c,
      -9 * e * s;
  return h;
}

MatrixXd hessian_of_second(const Vector3d& p) {
  const double x = p(0), y = p(1), z = p(2), l = std::log(y);
  MatrixXd h(3, 3);
  h << 0, 1 / y / z, -l / z / z, 1 / y / z, -x / y / y / z, -x / y / z / z, -l / z / z,
      -x / y / z / z, 2 * x * l / z / z / z;
  return h;
}

/// Functions that add noise of an amplitude, and have no value where `exists` is false.
template <class Exists>
Functions functions(double noise, Exists exists) {
  return [=](const MatrixXd& points) {
    MatrixXd all(2, points.cols());
    for (Index i = 0; i < points.cols(); ++i) {
      all.col(i) = values(points.col(i)).array() + noise * std::sin(1e7 * points.col(i).sum());
      if (!exists(points.col(i))) all.col(i).setConstant(undefined);
    }
    return all;
  };
}

bool everywhere(const Vector3d&) { return true; }

const Vector3d point{0.7, 1.4, 0.9};

/// The largest error of an entry, relative to the largest entry.
double error(const MatrixXd& found, const MatrixXd& exact) {
  return (found - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

void check_expansion(const Expansion& expansion, double first, double second) {
  CHECK(error(expansion.values, values(point)) < 1e-12);
  CHECK(error(expansion.gradients, gradients(point)) < first);
  REQUIRE(expansion.hessians.size() == 2);
  CHECK(error(expansion.hessians[0], hessian_of_first(point)) < second);
  CHECK(error(expansion.hessians[1], hessian_of_second(point)) < second);
}

}  // namespace

TEST_CASE("First derivatives agree with closed forms to 1e-12 and second ones to 1e-8") {
  check_expansion(expand(functions(0, everywhere), point, accurate_steps, true), 1e-12, 1e-8);
}

TEST_CASE("Without Hessians the gradients are the same") {
  const Functions f = functions(0, everywhere);
  const Expansion with = expand(f, point, accurate_steps, true);
  const Expansion without = expand(f, point, accurate_steps, false);
  CHECK(without.gradients == with.gradients);
  CHECK(without.values == with.values);
  CHECK(without.hessians.empty());
}

TEST_CASE("All points are evaluated in one call, as many as the header says") {
  int calls = 0;
  Index points_seen = 0;
  const auto count = [&](const MatrixXd& points) {
    ++calls;
    points_seen = points.cols();
    return MatrixXd(MatrixXd::Ones(1, points.cols()));
  };
  expand(count, point, {0.01, 5}, false);
  CHECK(points_seen == 1 + 2 * 3 * 5);
  expand(count, point, {0.01, 5}, true);
  CHECK(points_seen == 1 + 3 * 4 * 5);
  CHECK(calls == 2);
}

TEST_CASE("Steps that lead to points without a value are left out") {
  const auto f = functions(0, [](const Vector3d& p) { return (p - point).norm() < 1.5e-3; });
  check_expansion(expand(f, point, accurate_steps, true), 1e-10, 1e-5);
  const std::vector<double> quotients{undefined, 3, undefined, 3, 3};
  CHECK(extrapolate(quotients, 2).value == 3);
}

TEST_CASE("There is no derivative where no step leads to values") {
  const auto f = functions(0, [](const Vector3d& p) { return p(1) <= point(1); });
  const Expansion expansion = expand(f, point, accurate_steps, true);
  CHECK(std::isnan(expansion.gradients(0, 1)));
  CHECK(std::isnan(expansion.hessians[0](1, 1)));
  CHECK(expansion.gradients(0, 0) == Approx(gradients(point)(0, 0)));
  CHECK(std::isnan(extrapolate({}, 2).value));
  CHECK(std::isinf(extrapolate(std::vector{undefined, undefined}, 1).error));
}

TEST_CASE("Noise of 1e-12 leaves first derivatives accurate to 1e-9 and second ones to 1e-6") {
  check_expansion(expand(functions(1e-12, everywhere), point, accurate_steps, true), 1e-9, 1e-6);
}

TEST_CASE("One-sided quotients give the derivative, to within the estimate of its error") {
  for (const double noise : {0.0, 1e-12, 1e-9}) {
    std::vector<double> central, one_sided;
    for (int k = 0; k < 8; ++k) {
      const double h = std::ldexp(0.05, -k), error = noise * (k % 2 == 0 ? 1 : -1);
      central.push_back((std::exp(1 + h) - std::exp(1 - h) + error) / (2 * h));
      one_sided.push_back((std::exp(1 + h) - std::exp(1) + error) / h);
    }
    for (const auto& [quotients, order] : {std::pair(central, 2), std::pair(one_sided, 1)}) {
      const Derivative derivative = extrapolate(quotients, order);
      const double difference = std::abs(derivative.value - std::numbers::e);
      CHECK(difference < 1e-10 + 1e4 * noise);
      CHECK(difference < 4 * derivative.error + 1e-12);
      CHECK(derivative.error < 1e-9 + 1e4 * noise);
    }
  }
}

TEST_CASE("At the edge of the domain derivatives are one-sided, and no point is beyond it") {
  const auto functions = [](const Eigen::MatrixXd& points) {
    Eigen::MatrixXd values(1, points.cols());
    for (Eigen::Index p = 0; p < points.cols(); ++p)
      values(p) = points(0, p) < 0.5 || points(1, p) > 2
                      ? std::nan("")
                      : std::exp(points(0, p)) * std::sin(points(1, p));
    return values;
  };
  const Domain domain{Eigen::Vector2d(0.5, -HUGE_VAL), Eigen::Vector2d(HUGE_VAL, 2)};
  for (const double x : {0.5, 0.505, 0.6})
    for (const double y : {1.0, x < 0.51 ? 1.0 : 2.0}) {  // one edge at a time
      const Expansion e = expand(functions, Eigen::Vector2d(x, y), accurate_steps, true, domain);
      const double s = std::exp(x) * std::sin(y), c = std::exp(x) * std::cos(y);
      CHECK(e.gradients(0, 0) == Approx(s).epsilon(1e-8));
      CHECK(e.gradients(0, 1) == Approx(c).epsilon(1e-8));
      CHECK(e.hessians[0](0, 0) == Approx(s).epsilon(1e-4));
      CHECK(e.hessians[0](1, 1) == Approx(-s).epsilon(1e-4));
      CHECK(e.hessians[0](0, 1) == Approx(c).epsilon(1e-4));
    }
}
