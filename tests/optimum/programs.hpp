#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "trebsweep/optimum/nonlinear_program.hpp"

namespace trebsweep {

/// A nonlinear program with its published solution.
struct SolvedProgram {
  std::string name;
  NonlinearProgram program;
  Eigen::VectorXd start, solution;
  double objective;
  Eigen::VectorXd multipliers;  ///< of the constraints, lower bounds and upper bounds
};

inline Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// A program whose functions are given at one point.
template <class F>
NonlinearProgram program_of(F values, Eigen::Index objectives, Eigen::Index constraints,
                            const std::vector<double>& lower, const std::vector<double>& upper) {
  const auto functions = [=](const Eigen::MatrixXd& points) {
    Eigen::MatrixXd all(objectives + constraints, points.cols());
    for (Eigen::Index p = 0; p < points.cols(); ++p) all.col(p) = vector(values(points.col(p)));
    return all;
  };
  return {functions, objectives, constraints, vector(lower), vector(upper)};
}

/// Test problems 24, 35, 43 and 76 of W. Hock and K. Schittkowski, Test Examples for Nonlinear
/// Programming Codes (1981), as maximizations.
inline std::vector<SolvedProgram> hock_schittkowski() {
  using X = Eigen::VectorXd;
  const double r3 = std::sqrt(3);
  const auto hs24 = [=](const X& x) -> std::vector<double> {
    return {(9 - std::pow(x(0) - 3, 2)) * std::pow(x(1), 3) / (27 * r3), x(1) - x(0) / r3,
            -x(0) - r3 * x(1), x(0) + r3 * x(1) - 6};
  };
  const auto hs35 = [](const X& x) -> std::vector<double> {
    return {-(9 - 8 * x(0) - 6 * x(1) - 4 * x(2) + 2 * x(0) * x(0) + 2 * x(1) * x(1) + x(2) * x(2) +
              2 * x(0) * x(1) + 2 * x(0) * x(2)),
            x(0) + x(1) + 2 * x(2) - 3};
  };
  const auto hs43 = [](const X& x) -> std::vector<double> {
    const double a = x(0) * x(0), b = x(1) * x(1), c = x(2) * x(2), d = x(3) * x(3);
    return {-(a + b + 2 * c + d - 5 * x(0) - 5 * x(1) - 21 * x(2) + 7 * x(3)),
            a + b + c + d + x(0) - x(1) + x(2) - x(3) - 8, a + 2 * b + c + 2 * d - x(0) - x(3) - 10,
            2 * a + b + c + 2 * x(0) - x(1) - x(3) - 5};
  };
  const auto hs76 = [](const X& x) -> std::vector<double> {
    return {-(x(0) * x(0) + x(1) * x(1) / 2 + x(2) * x(2) + x(3) * x(3) / 2 - x(0) * x(2) +
              x(2) * x(3) - x(0) - 3 * x(1) + x(2) - x(3)),
            x(0) + 2 * x(1) + x(2) + x(3) - 5, 3 * x(0) + x(1) + 2 * x(2) - x(3) - 4,
            1.5 - x(1) - 4 * x(2)};
  };
  return {{"24", program_of(hs24, 1, 3, {0, 0}, {6, 6}), vector({1, 0.5}), vector({3, r3}), 1,
           vector({r3 / 2, 0, 0.5, 0, 0, 0, 0})},
          {"35", program_of(hs35, 1, 1, {0, 0, 0}, {4, 4, 4}), vector({0.5, 0.5, 0.5}),
           vector({4 / 3., 7 / 9., 4 / 9.}), -1 / 9., vector({2 / 9., 0, 0, 0, 0, 0, 0})},
          {"43", program_of(hs43, 1, 3, {-5, -5, -5, -5}, {5, 5, 5, 5}), vector({0, 0, 0, 0}),
           vector({0, 1, 2, -1}), 44, vector({1, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0})},
          {"76", program_of(hs76, 1, 3, {0, 0, 0, 0}, {5, 5, 5, 5}), vector({0.5, 0.5, 0.5, 0.5}),
           vector({3 / 11., 23 / 11., 0, 6 / 11.}), 103 / 22.,
           vector({5 / 11., 0, 0, 0, 0, 19 / 11., 0, 0, 0, 0, 0})}};
}

/// The minimax problems of C. Charalambous and A. R. Conn, SIAM J. Numer. Anal. 15 (1978) 162,
/// which are to maximize the smallest of three functions: with one at a vertex, and without.
inline std::vector<SolvedProgram> minimax() {
  const auto problem = [](int i, int j) {
    return [=](const Eigen::VectorXd& x) -> std::vector<double> {
      return {-std::pow(x(0), i) - std::pow(x(1), j),
              -std::pow(2 - x(0), 2) - std::pow(2 - x(1), 2), -2 * std::exp(x(1) - x(0))};
    };
  };
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(4);
  return {{"CB2", program_of(problem(2, 4), 3, 0, {-1, -1}, {4, 4}), vector({1, -0.1}),
           vector({1.1390376520, 0.8995599384}), -1.9522244939, none},
          {"CB3", program_of(problem(4, 2), 3, 0, {-1, -1}, {4, 4}), vector({2, 2}), vector({1, 1}),
           -2, none}};
}

}  // namespace trebsweep
