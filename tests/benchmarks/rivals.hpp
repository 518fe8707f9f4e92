#pragma once

#include <cvode/cvode.h>
#include <gsl/gsl_odeiv2.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_dopri5.hpp>
#include <boost/numeric/odeint/stepper/generation/make_controlled.hpp>
#include <cmath>
#include <functional>

#include "trebsweep/model/motion.hpp"
#include "trebsweep/model/start.hpp"

/// Other ODE solvers: each integrates one design of the paper's scene with the program's equations,
/// at a relative and absolute tolerance, and returns the speed at phi1 = pi (m/s).
namespace rivals {

using namespace trebsweep;

inline constexpr double pi = boost::math::double_constants::pi;

/// The speed at phi1 = pi, located by Newton's method on the length h of a last step; step(h) is
/// the state after it.
template <class Step>
double speed_at_release(const Design<double>& design, double h, Step step) {
  State<double> x{};
  for (int i = 0; i < 20; ++i) {
    x = step(h);
    if (std::abs(x[phi1] - pi) < 1e-14) break;
    h += (pi - x[phi1]) / x[w1];
  }
  return Mechanism<double>(Scene{}, design).speed(x);
}

using PlainDopri5 = odeint::runge_kutta_dopri5<State<double>>;

/// Odeint used as in its manual.
inline double odeint_speed(const Design<double>& design, double tolerance) {
  const Motion<double> motion(Scene{}, design);
  const auto system = std::cref(motion);
  auto stepper = odeint::make_controlled(tolerance, tolerance, PlainDopri5());
  State<double> x = start(Scene{}, design);
  double t = 0, h = 0.01;
  for (;;) {
    const State<double> before = x;
    const double at = t;
    while (stepper.try_step(system, x, t, h) == odeint::fail) {
    }
    if (x[phi1] < pi) continue;
    return speed_at_release(design, t - at, [&](double step) {
      PlainDopri5 plain;  // a new one, since a used one keeps the rates of its last step
      State<double> to = before;
      plain.do_step(system, to, at, step);
      return to;
    });
  }
}

inline int gsl_rates(double, const double x[], double dxdt[], void* motion) {
  State<double> rates;
  (*static_cast<Motion<double>*>(motion))({x[0], x[1], x[2], x[3]}, rates, 0);
  std::copy(rates.begin(), rates.end(), dxdt);
  return 0;
}

inline double gsl_speed(const Design<double>& design, double tolerance) {
  Motion<double> motion(Scene{}, design);
  gsl_odeiv2_system system{gsl_rates, nullptr, 4, &motion};
  gsl_odeiv2_step* step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, 4);
  gsl_odeiv2_control* control = gsl_odeiv2_control_y_new(tolerance, tolerance);
  gsl_odeiv2_evolve* evolve = gsl_odeiv2_evolve_alloc(4);
  State<double> x = start(Scene{}, design), before = x;
  double t = 0, h = 0.01, at = 0;
  while (x[phi1] < pi) {
    before = x;
    at = t;
    gsl_odeiv2_evolve_apply(evolve, control, step, &system, &t, 10, &h, x.data());
  }
  const double speed = speed_at_release(
      design, (t - at) * (pi - before[phi1]) / (x[phi1] - before[phi1]), [&](double length) {
        State<double> to = before, error;
        gsl_odeiv2_step_reset(step);
        gsl_odeiv2_step_apply(step, at, length, to.data(), error.data(), nullptr, nullptr, &system);
        return to;
      });
  gsl_odeiv2_evolve_free(evolve);
  gsl_odeiv2_control_free(control);
  gsl_odeiv2_step_free(step);
  return speed;
}

inline int cvode_rates(double t, N_Vector x, N_Vector dxdt, void* motion) {
  return gsl_rates(t, N_VGetArrayPointer(x), N_VGetArrayPointer(dxdt), motion);
}

inline int cvode_event(double, N_Vector x, double* event, void*) {
  *event = N_VGetArrayPointer(x)[phi1] - pi;
  return 0;
}

inline double cvode_speed(const Design<double>& design, double tolerance) {
  Motion<double> motion(Scene{}, design);
  const State<double> at_rest = start(Scene{}, design);
  SUNContext context;
#if SUNDIALS_VERSION_MAJOR >= 7
  SUNContext_Create(SUN_COMM_NULL, &context);
#else
  SUNContext_Create(nullptr, &context);
#endif
  N_Vector x = N_VNew_Serial(4, context);
  std::copy(at_rest.begin(), at_rest.end(), N_VGetArrayPointer(x));
  void* cvode = CVodeCreate(CV_ADAMS, context);
  CVodeInit(cvode, cvode_rates, 0, x);
  CVodeSStolerances(cvode, tolerance, tolerance);
  CVodeSetUserData(cvode, &motion);
  CVodeSetMaxNumSteps(cvode, 100000);
  SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(x, 0, context);
  CVodeSetNonlinearSolver(cvode, solver);
  CVodeRootInit(cvode, 1, cvode_event);
  double t = 0;
  CVode(cvode, 10, x, &t, CV_NORMAL);
  State<double> end;
  std::copy_n(N_VGetArrayPointer(x), 4, end.begin());
  SUNNonlinSolFree(solver);
  CVodeFree(&cvode);
  N_VDestroy(x);
  SUNContext_Free(&context);
  return Mechanism<double>(Scene{}, design).speed(end);
}

}  // namespace rivals
