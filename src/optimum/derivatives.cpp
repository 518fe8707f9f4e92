#include "trebsweep/optimum/derivatives.hpp"

#include <algorithm>
#include <cmath>

namespace trebsweep {

Derivative extrapolate(std::span<const double> quotients, int order) {
  Derivative best;
  std::vector<double> row, last;  // of the tableau
  for (const double quotient : quotients) {
    if (std::isnan(quotient)) continue;
    row = {quotient};
    if (last.empty()) best.value = quotient;
    double factor = 1;  // by which a term of the error shrinks with the step
    while (row.size() <= last.size()) {
      factor *= std::pow(2, order);
      const double coarser = last[row.size() - 1], finer = row.back();
      row.push_back(finer + (finer - coarser) / (factor - 1));
      const double error = std::max(std::abs(row.back() - finer), std::abs(row.back() - coarser));
      if (error <= best.error) best = {row.back(), error};
    }
    last = row;
  }
  return best;
}

Expansion expand(const Functions& functions, const Eigen::VectorXd& x, const Steps& steps,
                 bool with_hessians) {
  const int levels = steps.levels;
  const Eigen::Index n = x.size();
  std::vector<Eigen::VectorXd> lines;
  for (Eigen::Index i = 0; i < n; ++i) lines.push_back(Eigen::VectorXd::Unit(n, i));
  if (with_hessians)
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        lines.push_back(Eigen::VectorXd::Unit(n, i) + Eigen::VectorXd::Unit(n, j));

  const auto step = [&](int level) { return std::ldexp(steps.largest, -level); };
  Eigen::MatrixXd points(n, 1 + 2 * levels * static_cast<Eigen::Index>(lines.size()));
  Eigen::Index column = 0;
  points.col(column++) = x;
  for (const Eigen::VectorXd& line : lines)
    for (int k = 0; k < levels; ++k) {
      points.col(column++) = x + step(k) * line;
      points.col(column++) = x - step(k) * line;
    }
  const Eigen::MatrixXd values = functions(points);

  Expansion expansion{values.col(0), Eigen::MatrixXd(values.rows(), n), {}};
  std::vector<double> first(static_cast<std::size_t>(levels)), second(first.size());
  for (Eigen::Index f = 0; f < values.rows(); ++f) {
    Eigen::MatrixXd hessian(n, n);
    column = 1;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      for (int k = 0; k < levels; ++k, column += 2) {
        const double up = values(f, column), down = values(f, column + 1), h = step(k);
        first[static_cast<std::size_t>(k)] = (up - down) / (2 * h);
        second[static_cast<std::size_t>(k)] = (up - 2 * values(f, 0) + down) / (h * h);
      }
      const auto i = static_cast<Eigen::Index>(l);
      if (i < n) expansion.gradients(f, i) = extrapolate(first, 2).value;
      if (!with_hessians) continue;
      const double bend = extrapolate(second, 2).value;
      if (i < n)
        hessian(i, i) = bend;
      else
        for (Eigen::Index a = 0; a < n; ++a)
          for (Eigen::Index b = 0; b < a; ++b)
            if (lines[l](a) * lines[l](b) != 0)
              hessian(a, b) = hessian(b, a) = (bend - hessian(a, a) - hessian(b, b)) / 2;
    }
    if (with_hessians) expansion.hessians.push_back(hessian);
  }
  return expansion;
}

}  // namespace trebsweep
