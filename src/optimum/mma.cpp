#include "trebsweep/optimum/mma.hpp"

#include <algorithm>
#include <cmath>
#include <nlopt.hpp>
#include <vector>

#include "trebsweep/optimum/derivatives.hpp"

namespace trebsweep {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// A program as NLopt calls it: the variables are x and, if there are several objectives, a bound t
/// of all of them, which is then the objective.
class NloptProblem {
 public:
  NloptProblem(const NonlinearProgram& program, const VectorXd& start) : program_(program) {
    evaluate(start);
  }

  bool has_bound() const { return program_.objectives > 1; }
  Index variables() const { return program_.variables() + has_bound(); }
  Index constraints() const {
    return program_.constraints + (has_bound() ? program_.objectives : 0);
  }
  const Point& best() const { return best_; }

  double objective(const double* y, double* gradient) {
    if (has_bound()) {
      if (gradient) std::fill_n(gradient, variables(), 0.0), gradient[variables() - 1] = 1;
      return y[variables() - 1];
    }
    evaluate(Eigen::Map<const VectorXd>(y, program_.variables()));
    if (gradient) copy_row(0, 1, gradient);
    return value(0, -HUGE_VAL);
  }

  void constrain(double* result, const double* y, double* gradient) {
    evaluate(Eigen::Map<const VectorXd>(y, program_.variables()));
    Index i = 0;
    const auto next_gradient = [&] { return gradient + variables() * i; };
    if (has_bound())
      for (; i < program_.objectives; ++i) {
        result[i] = y[variables() - 1] - value(i, -HUGE_VAL);
        if (gradient) copy_row(i, -1, next_gradient()), next_gradient()[variables() - 1] = 1;
      }
    for (Index f = program_.objectives; i < constraints(); ++i, ++f) {
      result[i] = value(f, HUGE_VAL);
      if (gradient) copy_row(f, 1, next_gradient());
    }
  }

 private:
  /// Expands the functions at x and keeps the best point.
  void evaluate(const VectorXd& x) {
    if (at_.size() > 0 && x == at_) return;
    at_ = x;
    expansion_ = expand(program_.functions, x, quick_steps, false);
    const Point point = point_of(program_, x, expansion_.values);
    if (best_.x.size() == 0 || is_better(point, best_)) best_ = point;
  }

  double value(Index function, double otherwise) const {
    const double value = expansion_.values(function);
    return std::isnan(value) ? otherwise : value;
  }

  void copy_row(Index function, double factor, double* to) const {
    to[variables() - 1] = 0;  // the derivative with respect to the bound, if there is one
    for (Index i = 0; i < program_.variables(); ++i) {
      const double slope = factor * expansion_.gradients(function, i);
      to[i] = std::isfinite(slope) ? slope : 0;
    }
  }

  const NonlinearProgram& program_;
  VectorXd at_;  // the point of the expansion
  Expansion expansion_;
  Point best_;
};

}  // namespace

Point search_by_mma(const NonlinearProgram& program, const VectorXd& start) {
  NloptProblem problem(program, start);
  const auto n = static_cast<unsigned>(problem.variables());
  const auto with_bound = [&](const VectorXd& x, double t) {
    std::vector<double> y(x.begin(), x.end());
    if (problem.has_bound()) y.push_back(t);
    return y;
  };
  nlopt::opt opt(nlopt::LD_MMA, n);
  opt.set_lower_bounds(with_bound(program.lower, -HUGE_VAL));
  opt.set_upper_bounds(with_bound(program.upper, HUGE_VAL));
  opt.set_max_objective(
      [](unsigned, const double* y, double* gradient, void* data) {
        return static_cast<NloptProblem*>(data)->objective(y, gradient);
      },
      &problem);
  if (problem.constraints() > 0)
    opt.add_inequality_mconstraint(
        [](unsigned, double* result, unsigned, const double* y, double* gradient, void* data) {
          static_cast<NloptProblem*>(data)->constrain(result, y, gradient);
        },
        &problem, std::vector<double>(static_cast<std::size_t>(problem.constraints()), 0.0));
  opt.set_xtol_abs(1e-5);
  opt.set_maxeval(60);
  std::vector<double> y = with_bound(problem.best().x, problem.best().objective);
  double value = 0;
  try {
    opt.optimize(y, value);
  } catch (const nlopt::roundoff_limited&) {
    // The best point is close enough all the same.
  }
  return problem.best();
}

}  // namespace trebsweep
