#include "trebsweep/optimum/allowance.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace trebsweep {
namespace {

/// The smallest relative change of a length, up to `sign` * 1/2, at which the objective falls
/// below a value or does not exist.
double first_loss(const DesignProblem& problem, const Design<double>& design, std::size_t length,
                  double sign, double least, std::uint64_t& integrated) {
  constexpr int parts = 64;  // of the interval, per round
  constexpr double precision = 1e-7;
  double low = 0, high = 0.5;
  while (high - low > precision) {
    std::vector<Design<double>> designs;
    for (int i = 1; i <= parts; ++i) {
      std::array<double, 3> r = lengths(design);
      r[length] *= 1 + sign * (low + (high - low) * i / parts);
      designs.push_back({r[0], r[1], r[2]});
    }
    integrated += designs.size();
    const Eigen::MatrixXd values = values_at(problem, designs);
    int i = 0;
    while (i < parts && values(0, i) >= least) ++i;  // false for NaN
    if (i == parts) return std::numeric_limits<double>::infinity();
    const double part = (high - low) / parts;
    low += part * i;
    high = low + part;
  }
  return (low + high) / 2;
}

}  // namespace

std::array<Allowance, 3> allowances(const DesignProblem& problem, const Design<double>& design,
                                    std::uint64_t& integrated) {
  ++integrated;
  const double value = values_at(problem, {&design, 1})(0, 0);
  const double least = value - 0.01 * std::abs(value);
  std::array<Allowance, 3> all{};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto loss = [&](double sign) {
      return lengths(design)[d] * first_loss(problem, design, d, sign, least, integrated);
    };
    all[d] = {loss(-1), loss(1)};
  }
  return all;
}

}  // namespace trebsweep
