#include "trebsweep/optimum/cma_es.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Constants of the adaptation, in the notation of Hansen's table 1.
struct Constants {
  VectorXd weights;  // of the better half of the samples, best first
  double mu_eff, c_c, c_1, c_mu;
};

Constants constants(Index dimensions, Index samples) {
  const auto n = static_cast<double>(dimensions);
  const VectorXd rank = VectorXd::LinSpaced(samples / 2, 1, static_cast<double>(samples / 2));
  VectorXd weights = std::log(static_cast<double>(samples + 1) / 2) - rank.array().log();
  weights /= weights.sum();
  const double mu = 1 / weights.squaredNorm();
  const double c_1 = 2 / ((n + 1.3) * (n + 1.3) + mu);
  return {.weights = weights,
          .mu_eff = mu,
          .c_c = (4 + mu / n) / (n + 4 + 2 * mu / n),
          .c_1 = c_1,
          .c_mu = std::min(1 - c_1, 2 * (mu - 2 + 1 / mu) / ((n + 2) * (n + 2) + mu))};
}

/// Where samples are drawn, and what the adaptation remembers.
struct Distribution {
  VectorXd mean;
  MatrixXd covariance;
  double step_size = 1;
  VectorXd path;
  double success = 0;
  double penalty = 0.1;  // for a violation, in units of the objective
};

/// What a sample is ranked by: points that violate the constraints a little show the way along
/// these.
double merit(const Point& point, double penalty) {
  return point.objective - penalty * point.violation;
}

/// Points of the distribution within the bounds. Some in a row share the last variables, which are
/// not cheap: by an upper triangular factor of the covariance, these depend on the last normal
/// numbers only.
MatrixXd sample(const Distribution& d, const MatrixXd& upper_factor,
                const NonlinearProgram& program, Index count, Index together,
                boost::random::mt19937_64& random) {
  boost::random::normal_distribution<double> normal;
  const Index n = program.variables(), dear = n - program.cheap_variables;
  MatrixXd points(n, count);
  for (double& z : points.reshaped()) z = normal(random);
  for (Index i = 0; i < count; ++i)
    points.col(i).tail(dear) = points.col(i - i % together).tail(dear);
  points = ((d.step_size * upper_factor * points).colwise() + d.mean).eval();
  for (auto point : points.colwise())
    point = point.cwiseMax(program.lower).cwiseMin(program.upper).eval();
  return points;
}

/// Moves the distribution towards the better samples, which come first. For variables that samples
/// share, the path is longer than that of independent samples.
void adapt_shape(Distribution& d, const Constants& c, const std::vector<Point>& samples) {
  MatrixXd y(d.mean.size(), c.weights.size());
  for (Index i = 0; i < y.cols(); ++i)
    y.col(i) = (samples[static_cast<std::size_t>(i)].x - d.mean) / d.step_size;
  const VectorXd step = y * c.weights;
  d.mean += d.step_size * step;
  d.path = (1 - c.c_c) * d.path + std::sqrt(c.c_c * (2 - c.c_c) * c.mu_eff) * step;
  d.covariance = (1 - c.c_1 - c.c_mu) * d.covariance + c.c_1 * d.path * d.path.transpose() +
                 c.c_mu * y * c.weights.asDiagonal() * y.transpose();
}

/// Changes the step size by how many samples are better than those before: the population success
/// rule of Loshchilov (GECCO 2014), since samples that share variables are not independent. With a
/// lower target than his 0.25 the steps shrink more slowly, and more starts lead to the best end.
void adapt_step_size(Distribution& d, const std::vector<Point>& samples,
                     const std::vector<Point>& before) {
  constexpr double target = 0.05, rate = 0.3;
  if (before.empty()) return;
  double balance = 0;
  for (const Point& a : samples)
    for (const Point& b : before) {
      const double gain = merit(a, d.penalty) - merit(b, d.penalty);
      balance += gain > 0 ? 1 : gain < 0 ? -1 : 0;
    }
  balance /= static_cast<double>(samples.size() * before.size());
  d.success += rate * (balance - target - d.success);
  d.step_size *= std::exp(d.success);
}

/// Keeps a part of the samples feasible.
void adapt_penalty(Distribution& d, const std::vector<Point>& samples) {
  constexpr double change = 1.2;
  constexpr std::ptrdiff_t part = 5;
  const bool are_few =
      part * std::ranges::count_if(samples, is_feasible<Point>) < std::ssize(samples);
  d.penalty *= are_few ? change : 1 / change;
}

}  // namespace

Point evolve(const NonlinearProgram& program, const VectorXd& start, const VectorXd& spread) {
  constexpr int generations = 200;
  constexpr double finest = 1e-3;
  const Index n = program.variables(), cheap = program.cheap_variables;
  const Index together = cheap > 0 ? 8 : 1, count = 2 * together * (n - cheap + 2);
  const Constants c = constants(n, count);
  Distribution d{
      .mean = start, .covariance = spread.cwiseAbs2().asDiagonal(), .path = VectorXd::Zero(n)};
  boost::random::mt19937_64 random(1);
  Point best = point_of(program, start, program.functions(start).col(0));
  std::vector<Point> before;
  for (int generation = 0; generation < generations; ++generation) {
    const Eigen::LLT<MatrixXd> reversed{MatrixXd(d.covariance.reverse())};
    if (reversed.info() != Eigen::Success) break;  // the covariance is singular
    const MatrixXd lower = reversed.matrixL();
    const MatrixXd points = sample(d, lower.reverse(), program, count, together, random);
    const MatrixXd values = program.functions(points);
    std::vector<Point> samples;
    for (Index i = 0; i < count; ++i)
      samples.push_back(point_of(program, points.col(i), values.col(i)));
    for (const Point& point : samples)
      if (is_better(point, best)) best = point;
    std::ranges::stable_sort(samples, std::greater{},
                             [&](const Point& p) { return merit(p, d.penalty); });
    adapt_shape(d, c, samples);
    adapt_step_size(d, samples, before);
    adapt_penalty(d, samples);
    if (d.step_size * std::sqrt(d.covariance.diagonal().maxCoeff()) < finest) break;
    before = std::move(samples);
  }
  return best;
}

}  // namespace trebsweep
