#include "trebsweep/assess/stability.hpp"

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "trebsweep/assess/accuracy.hpp"
#include "trebsweep/model/jacobian.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/ode/rosenbrock_step.hpp"
#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

using Complex = std::complex<double>;

/// One step of an explicit stepper for y' = z y.
template <template <class...> class Stepper>
Complex explicit_step(const Complex& z) {
  using Y = std::array<Complex, 1>;
  Stepper<Y, double, Y, double, odeint::array_algebra, odeint::default_operations,
          odeint::never_resizer>
      stepper;
  const auto system = [&](const Y& y, Y& dydt, double) { dydt[0] = z * y[0]; };
  Y y{1};
  stepper.do_step(system, y, 0.0, 1.0);
  return y[0];
}

Complex rosenbrock_step(const Complex& z) {
  const std::array<double, 4> rows{z.real(), -z.imag(), z.imag(), z.real()};
  const auto rates = [&](const double* y, double* dydt) {
    dydt[0] = rows[0] * y[0] + rows[1] * y[1];
    dydt[1] = rows[2] * y[0] + rows[3] * y[1];
  };
  const auto derivatives = [&](const double*, double* j) {
    std::copy(rows.begin(), rows.end(), j);
  };
  const std::array<double, 2> one{1, 0};
  std::array<double, 2> y{}, error{};
  RosenbrockStep(2).step(rates, derivatives, one.data(), 1, y.data(), error.data());
  return {y[0], y[1]};
}

/// Whether a stable step must not amplify the mode.
bool is_bounded(const Complex& eigenvalue) {
  return eigenvalue.real() <= 0.1 * std::abs(eigenvalue.imag());
}

/// The durations of the phases of a swing, s: in the trough, if there is one, and after it.
struct Phases {
  double sliding;
  long double free;
};

Phases phases(const Scene& scene, const Design<double>& design, const Reference& reference) {
  const long double time = reference.release_time;
  if (!scene.trough) return {0, time};
  Solver solver;
  solver.stepper = "vern8";
  solver.tolerance = 1e-13;
  solver.release = Release::fastest;
  solver.max_time = static_cast<double>(time);
  SwingResult result;
  const Field field = Field::lift_off_time;
  double lift_off = std::numeric_limits<double>::quiet_NaN();
  integrate(scene, solver, {{&design, 1}, {&result, 1}, {&field, 1}, {&lift_off, 1}});
  const double sliding = std::fmin(lift_off, solver.max_time);
  return {sliding, time - sliding};
}

/// An Advance for steps of length h (s), in numbers of type T.
template <class T, Effects E>
using MakeAdvance = std::function<std::function<Instant<T, E>(
    const Motion<T, E>& motion, const Instant<T, E>& from, T h)>(double h)>;

/// error_of_steps() with the steps of an Advance.
template <class T, Effects E>
double error_with(const MakeAdvance<T, E>& make_advance, const Scene& scene,
                  const Design<double>& design, const Reference& reference,
                  const StepCounts& steps) {
  const Design<T> d{T(design.r1), T(design.r3), T(design.r2)};
  const auto [sliding, free] = phases(scene, design, reference);
  Motion<T, E> motion(scene, d);
  auto now = instant(motion, T(0), start<T, E>(scene, d));
  const auto integrate_phase = [&](const T& time, std::uint64_t count) {
    const T h = time / static_cast<T>(count);
    const auto advance = make_advance(static_cast<double>(h));
    for (std::uint64_t i = 0; i < count; ++i) now = advance(motion, now, h);
  };
  if constexpr (E.trough) {
    if (sliding > 0) integrate_phase(static_cast<T>(sliding), steps.sliding);
    motion.set_sliding(T(0));
    motion.rates(now.x, now.directions, now.dxdt);
  }
  if (free > 0) integrate_phase(static_cast<T>(free), steps.free);
  double largest = 0;
  for (std::size_t i = 0; i < coordinates<E>; ++i) {
    const long double truth = reference.state[i];
    const auto error = static_cast<double>(std::abs(now.x[i] - truth) / (1 + std::abs(truth)));
    largest = error <= largest ? largest : error;  // NaN stays
  }
  return std::isfinite(largest) ? largest : std::numeric_limits<double>::infinity();
}

/// The same with a stepper for packs, in extended precision, in which rounding hides the order of
/// fewer methods.
template <Effects E>
double extended_error(const std::string& stepper, const Scene& scene, const Design<double>& design,
                      const Reference& reference, const StepCounts& steps) {
  using Instant = trebsweep::Instant<long double, E>;
  return with_pack_stepper(
      stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
        Stepper<long double, E> method;
        const auto advance_by = [&](const Motion<long double, E>& motion, const Instant& from,
                                    long double h) {
          Instant to;
          State<long double, E> error;
          advance(method, motion, from, h, to, error);
          return to;
        };
        return error_with<long double, E>([&](double) { return advance_by; }, scene, design,
                                          reference, steps);
      });
}

}  // namespace

bool has_stability_function(const std::string& stepper) {
  return info_of_stepper(stepper).has_stability_function;
}

Complex stability_function(const std::string& stepper, const Complex& z) {
  switch (info_of_stepper(stepper).id) {
    case StepperId::euler:
      return explicit_step<odeint::euler>(z);
    case StepperId::modified_midpoint:
      return explicit_step<odeint::modified_midpoint>(z);
    case StepperId::rk4:
      return explicit_step<odeint::runge_kutta4>(z);
    case StepperId::cash_karp54:
      return explicit_step<odeint::runge_kutta_cash_karp54>(z);
    case StepperId::dopri5:
      return explicit_step<odeint::runge_kutta_dopri5>(z);
    case StepperId::fehlberg78:
      return explicit_step<odeint::runge_kutta_fehlberg78>(z);
    case StepperId::vern7:
      return explicit_step<Verner76>(z);
    case StepperId::vern8:
      return explicit_step<Verner87>(z);
    case StepperId::rosenbrock4:
      return rosenbrock_step(z);
    case StepperId::adams_bashforth_moulton:
    case StepperId::bulirsch_stoer:
      break;
  }
  throw std::logic_error("no stability function of " + stepper);
}

double amplification(const std::string& stepper, const std::vector<Spectrum>& spectra, double h) {
  double exponent = 0;
  for (const Spectrum& spectrum : spectra) {
    double growth = 0;  // per step
    for (const Complex& eigenvalue : spectrum.eigenvalues)
      if (is_bounded(eigenvalue))
        growth = std::max(growth, std::log(std::abs(stability_function(stepper, h * eigenvalue))) -
                                      std::max(0.0, h * eigenvalue.real()));
    exponent += spectrum.h / h * growth;
  }
  return std::exp(exponent);
}

double largest_stable_step(const std::string& stepper, const std::vector<Spectrum>& spectra) {
  const double modulus = stiffness(spectra).modulus;
  // Upwards from very short steps, so that the first unstable step ends the search.
  const double ratio = std::pow(2, 1.0 / 32);
  double h = 1e-4 / modulus;
  while (h < 1e4 / modulus && amplification(stepper, spectra, h * ratio) < 2) h *= ratio;
  return h < 1e4 / modulus ? h : std::numeric_limits<double>::infinity();
}

double error_of_steps(const std::string& stepper, const Scene& scene, const Design<double>& design,
                      const Reference& reference, const StepCounts& steps) {
  return with_general_effects(scene, [&]<Effects E>() {
    if (is_for_packs(stepper)) return extended_error<E>(stepper, scene, design, reference, steps);
    const auto make = [&](double h) {
      Solver solver;
      solver.stepper = stepper;
      solver.time_step = h;
      return make_advance<E>(scene, design, solver);
    };
    return error_with<double, E>(make, scene, design, reference, steps);
  });
}

double largest_usable_step(const std::string& stepper, const Scene& scene,
                           const Design<double>& design, const Reference& reference, double guess) {
  constexpr double max_steps = 1e7;
  const auto time = static_cast<double>(reference.release_time);
  const auto [sliding, rest] = phases(scene, design, reference);
  const auto free = static_cast<double>(rest);
  const double ratio = std::pow(2, 1.0 / 8);
  double usable = std::numeric_limits<double>::quiet_NaN();
  for (double h = std::min(guess / 4, time / 8); h < time; h *= ratio) {
    if (time / h > max_steps) break;
    const auto steps_in = [&](double duration) {
      return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(duration / h)));
    };
    const StepCounts steps{steps_in(sliding), steps_in(free)};
    if (error_of_steps(stepper, scene, design, reference, steps) > 0.1) break;
    usable = std::max(sliding / static_cast<double>(steps.sliding),
                      free / static_cast<double>(steps.free));
  }
  return usable;
}

namespace {

template <Effects E>
Growth growth_with(const std::string& stepper, const Scene& scene, const Design<double>& design,
                   double h, double time) {
  Motion<double, E> motion(scene, design);
  motion.set_sliding(0);
  const Mechanism<double, E> mechanism(scene, design);
  State<double, E> hanging{};
  hanging[phi1] = boost::math::double_constants::pi;
  const Jacobian<E> matrix = jacobian(motion, hanging);
  const std::vector<Mode> all = modes({matrix.data(), static_cast<std::size_t>(matrix.size())});
  const auto& [eigenvalue, eigenvector] =
      *std::ranges::max_element(all, {}, [](const Mode& mode) { return mode.eigenvalue.imag(); });
  const auto steps = static_cast<std::uint64_t>(std::ceil(time / h));

  constexpr double small = 1e-3;  // rad: a relative error of 1e-6 in the linearized energy
  State<double, E> x = hanging;
  for (std::size_t i = 0; i < x.size(); ++i) x[i] += small * eigenvector[i].real();
  const auto energy = [&](const State<double, E>& state) {
    return mechanism.energy(state) - mechanism.energy(hanging);
  };
  const double at_start = energy(x);
  Solver solver;
  solver.stepper = stepper;
  solver.time_step = h;
  const auto advance = make_advance<E>(scene, design, solver);
  auto now = instant(motion, 0.0, x);
  for (std::uint64_t i = 0; i < steps; ++i) now = advance(motion, now, h);
  const double predicted =
      std::pow(std::abs(stability_function(stepper, h * eigenvalue)), static_cast<double>(steps));
  return {eigenvalue.imag(), predicted, std::sqrt(energy(now.x) / at_start)};
}

}  // namespace

Growth growth(const std::string& stepper, const Scene& scene, const Design<double>& design,
              double h, double time) {
  return with_general_effects(
      scene, [&]<Effects E>() { return growth_with<E>(stepper, scene, design, h, time); });
}

double observed_order(const std::string& stepper, const Scene& scene,
                      std::span<const Design<double>> designs,
                      std::span<const Reference> references) {
  constexpr double asymptotic = 1e-3;
  // Twenty times that of one step; steppers for packs run in long double.
  const double rounding = is_for_packs(stepper) ? 1e-18 : 2e-15;
  constexpr std::uint64_t max_steps = 1 << 15;
  std::vector<double> orders;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (!has_speed(references[i].status)) continue;
    double order = std::numeric_limits<double>::quiet_NaN(), last = 1;
    for (std::uint64_t steps = 4; steps <= max_steps; steps *= 2) {
      const StepCounts counts =
          scene.trough ? StepCounts{steps / 2, steps / 2} : StepCounts{0, steps};
      const double error = error_of_steps(stepper, scene, designs[i], references[i], counts);
      if (error < rounding * static_cast<double>(steps)) break;
      if (last < asymptotic) order = std::log2(last / error);
      last = error;
    }
    if (!std::isnan(order)) orders.push_back(order);
  }
  return error_quantiles(std::move(orders)).median;
}

}  // namespace trebsweep
