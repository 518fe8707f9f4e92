#include "trebsweep/swing/reference.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>

#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/swing_by.hpp"

namespace trebsweep {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

template <Effects E>
Outcome<Quad, E> swing_at(double tolerance, const Scene& scene, const Design<double>& design,
                          Solver solver) {
  solver.release = located(solver.release);
  solver.tolerance = tolerance;
  return swing_by<Quad, E>(Vern8<Quad, E>(), scene, design, solver);
}

/// A bound of the error of a result: its distance from the other one, plus rounding to double.
double bound(const Quad& result, const Quad& other) {
  return static_cast<double>(abs(Quad(result - other))) +
         std::numeric_limits<double>::epsilon() / 2 * std::abs(static_cast<double>(result));
}

}  // namespace

Reference reference(const Scene& scene, const Design<double>& design, const Solver& solver) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return with_effects(scene, [&]<Effects E>() {
    const auto loose = swing_at<E>(1e-14, scene, design, solver);
    const auto tight = swing_at<E>(1e-16, scene, design, solver);
    Reference r{tight.status, nan, nan, {}, nan, nan};
    for (std::size_t i = 0; i < coordinates<E>; ++i)
      r.state[i] = static_cast<long double>(tight.x[i]);
    if (!has_speed(tight.status)) return r;
    r.speed = static_cast<double>(tight.speed);
    r.release_time = static_cast<long double>(tight.t);
    if (loose.status != tight.status) return r;
    r.speed_bound = bound(tight.speed, loose.speed);
    r.time_bound = bound(tight.t, loose.t);
    return r;
  });
}

double speed_in_extended_precision(const Scene& scene, const Design<double>& design,
                                   double tolerance, const Solver& solver) {
  return with_effects(scene, [&]<Effects E>() {
    Solver limits = solver;
    limits.max_steps = 100'000;
    limits.release = located(limits.release);
    limits.tolerance = tolerance;
    const auto outcome = swing_by<long double, E>(Vern8<long double, E>(), scene, design, limits);
    return has_speed(outcome.status) ? static_cast<double>(outcome.speed)
                                     : std::numeric_limits<double>::quiet_NaN();
  });
}

}  // namespace trebsweep
