#include "trebsweep/ode/rosenbrock_step.hpp"

#include <algorithm>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <utility>

namespace trebsweep {
namespace {

using Stepper = boost::numeric::odeint::rosenbrock4<double>;
using Vector = Stepper::state_type;
using Matrix = Stepper::matrix_type;

}  // namespace

struct RosenbrockStep::Storage {
  Stepper stepper;
  Vector x, end, error;
};

RosenbrockStep::RosenbrockStep(std::size_t n)
    : storage_(new Storage{Stepper(), Vector(n), Vector(n), Vector(n)}) {}

RosenbrockStep::~RosenbrockStep() = default;

int RosenbrockStep::order() { return Stepper::stepper_order; }

int RosenbrockStep::error_order() { return Stepper::error_order; }

void RosenbrockStep::step(const Rates& rates, const Derivatives& derivatives, const double* x,
                          double h, double* end, double* error) {
  auto& [stepper, start, finish, difference] = *storage_;
  std::copy_n(x, start.size(), start.begin());
  const auto system = [&](const Vector& y, Vector& dydt, double) { rates(&y[0], &dydt[0]); };
  const auto jacobian = [&](const Vector& y, Matrix& j, double, Vector& dfdt) {
    derivatives(&y[0], &j(0, 0));
    std::fill(dfdt.begin(), dfdt.end(), 0.0);
  };
  stepper.do_step(std::make_pair(system, jacobian), start, 0.0, finish, h, difference);
  std::copy(finish.begin(), finish.end(), end);
  std::copy(difference.begin(), difference.end(), error);
}

}  // namespace trebsweep
