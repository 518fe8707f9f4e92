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

namespace {

/// The side to which all steps along a line stay in the domain: 0 for both, else 1 or -1.
int side_of(const Eigen::VectorXd& x, const Eigen::VectorXd& line, double step,
            const Domain& domain) {
  if (domain.lower.size() == 0) return 0;
  const auto is_inside = [&](double by) {
    const Eigen::ArrayXd at = x + by * line;
    return (at >= domain.lower.array()).all() && (at <= domain.upper.array()).all();
  };
  if (is_inside(step) && is_inside(-step)) return 0;
  return is_inside(2 * step) ? 1 : -1;
}

}  // namespace

Expansion expand(const Functions& functions, const Eigen::VectorXd& x, const Steps& steps,
                 bool with_hessians, const Domain& domain) {
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
  std::vector<int> sides;
  for (const Eigen::VectorXd& line : lines) {
    const int side = sides.emplace_back(side_of(x, line, steps.largest, domain));
    for (int k = 0; k < levels; ++k) {
      points.col(column++) = x + (side == 0 ? 1 : side) * step(k) * line;
      points.col(column++) = x + (side == 0 ? -1 : 2 * side) * step(k) * line;
    }
  }
  const Eigen::MatrixXd values = functions(points);

  Expansion expansion{values.col(0), Eigen::MatrixXd(values.rows(), n), {}};
  std::vector<double> first(static_cast<std::size_t>(levels)), second(first.size());
  for (Eigen::Index f = 0; f < values.rows(); ++f) {
    Eigen::MatrixXd hessian(n, n);
    column = 1;
    for (std::size_t l = 0; l < lines.size(); ++l) {
      const int side = sides[l], order = side == 0 ? 2 : 1;
      const double here = values(f, 0);
      for (int k = 0; k < levels; ++k, column += 2) {
        // At x + h and x - h or, to one side, at x + h and x + 2 h.
        const double a = values(f, column), b = values(f, column + 1), h = step(k);
        const auto level = static_cast<std::size_t>(k);
        first[level] = side == 0 ? (a - b) / (2 * h) : side * (a - here) / h;
        second[level] = (side == 0 ? a - 2 * here + b : here - 2 * a + b) / (h * h);
      }
      const auto i = static_cast<Eigen::Index>(l);
      if (i < n) expansion.gradients(f, i) = extrapolate(first, order).value;
      if (!with_hessians) continue;
      const double bend = extrapolate(second, order).value;
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
