#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/root_finding.hpp"
#include "trebsweep/ode/step_size.hpp"
#include "trebsweep/ode/verner.hpp"

namespace trebsweep {

/// k in the acceleration -k |u| u of a projectile with velocity u relative to the air, 1/m.
inline double drag_constant(const Scene& scene) {
  const double area = std::atan(1) * scene.projectile_diameter * scene.projectile_diameter;
  return scene.air_density * scene.drag_coefficient * area / (2 * scene.projectile_mass);
}

/// A flight through air. Its state is (x, height, vx, vy) in m and m/s; with N = 8 it also has the
/// derivatives of these four along a change of the initial velocity.
template <class T, std::size_t N>
using FlightState = std::array<T, N>;

/// The equations of a flight with quadratic drag.
template <class T>
struct FlightEquations {
  T drag, gravity, wind;

  explicit FlightEquations(const Scene& scene)
      : drag(drag_constant(scene)), gravity(scene.gravity), wind(scene.wind) {}

  /// The rates of the state, times h (s).
  template <std::size_t N>
  FlightState<T, N> rates(const FlightState<T, N>& s, const T& h) const {
    using std::sqrt;
    const T ux = s[2] - wind, uy = s[3];
    const T tiny = std::numeric_limits<double>::min();  // derivatives at zero speed are zero
    const T speed = sqrt(T(ux * ux + uy * uy + tiny));
    const T k = h * drag, damping = k * speed;
    FlightState<T, N> rates;
    rates[0] = h * s[2];
    rates[1] = h * s[3];
    rates[2] = -damping * ux;
    rates[3] = -damping * uy - h * gravity;
    if constexpr (N == 8) {
      const T along = k * T(ux * s[6] + uy * s[7]) / speed;
      rates[4] = h * s[6];
      rates[5] = h * s[7];
      rates[6] = -damping * s[6] - along * ux;
      rates[7] = -damping * s[7] - along * uy;
    }
    return rates;
  }

  /// A time over which the speed through the air changes appreciably, s; never zero in flight.
  template <std::size_t N>
  T time_scale(const FlightState<T, N>& s) const {
    using std::sqrt;
    const T vx = s[2], vy = s[3], ux = vx - wind;
    const T air_speed = sqrt(T(ux * ux + vy * vy));
    const T speed = sqrt(T(vx * vx + vy * vy)) + sqrt(T(gravity * s[1]));
    return T(air_speed + T(1e-4) * speed) / T(gravity + drag * air_speed * air_speed);
  }
};

/// The state after a step, and the sum of the estimated relative errors of its vectors.
template <class T, std::size_t N>
struct FlightStep {
  FlightState<T, N> to;
  T error;
};

/// Takes a step of length h (s), which may be zero.
template <class T, std::size_t N>
FlightStep<T, N> advance_flight(const FlightEquations<T>& equations, const FlightState<T, N>& from,
                                const std::type_identity_t<T>& h) {
  using std::abs;
  using State = FlightState<T, N>;
  using Number = typename Lanes<T>::Number;
  // As in AdaptiveStepper, the independent variable is the fraction of the step.
  Verner87<State, Number, State, Number, Algebra, Operations, odeint::never_resizer> stepper;
  const auto system = [&](const State& s, State& rates, const Number&) {
    rates = equations.rates(s, h);
  };
  State error;
  FlightStep<T, N> step{{}, T(0)};
  stepper.do_step(system, from, Number(0), step.to, Number(1), error);
  const auto size = [](const State& s, std::size_t i) { return T(abs(s[i]) + abs(s[i + 1])); };
  const T smallest = std::numeric_limits<double>::min();
  for (std::size_t i = 0; i < N; i += 2)
    step.error += size(error, i) / T(size(from, i) + size(step.to, i) + smallest);
  return step;
}

/// The same for packs, with all of Odeint inlined.
template <std::size_t R, std::size_t N>
[[gnu::flatten]] FlightStep<Pack<R>, N> advance_flight(const FlightEquations<Pack<R>>& equations,
                                                       const FlightState<Pack<R>, N>& from,
                                                       const Pack<R>& h) {
  return advance_flight<Pack<R>, N>(equations, from, h);
}

/// A state of a flight and its time since the release, s.
template <class T, std::size_t N>
struct FlightInstant {
  T time;
  FlightState<T, N> s;
};

template <class Mask, class T, std::size_t N>
void set_nan(const Mask& lanes, FlightInstant<T, N>& at) {
  const T nan = std::numeric_limits<double>::quiet_NaN();
  at.time = select(lanes, nan, at.time);
  for (T& coordinate : at.s) coordinate = select(lanes, nan, coordinate);
}

/// An estimate of the zero in [0, 1] of the cubic with the given values and derivatives at 0 and 1,
/// the first value positive and the second not: three steps of Newton's method from the zero of the
/// chord.
template <class T>
T zero_of_cubic(const ValueAndSlope<T>& first, const ValueAndSlope<T>& last) {
  const T fall = first.value - last.value;
  const T bend = T(3) * -fall - T(2) * first.slope - last.slope;
  const T twist = T(2) * fall + first.slope + last.slope;
  T zero = first.value / fall;
  for (int i = 0; i < 3; ++i) {
    const T value = first.value + zero * T(first.slope + zero * T(bend + zero * twist));
    const T slope = first.slope + zero * T(T(2) * bend + T(3) * zero * twist);
    zero = zero - value / slope;
  }
  return zero;
}

/// Proceeds to the zero of coordinate i within a step of length h, which changes it by -fall. It is
/// located as in event_between(): root finding from `guess`, a fraction of the step, and then an
/// extrapolation over less than `precision` of the step. Lanes whose h is zero remain unchanged.
template <class T, std::size_t N>
void fly_to_zero(const FlightEquations<T>& equations, std::size_t i, const T& h, const T& fall,
                 const T& guess, double precision, FlightInstant<T, N>& at) {
  const auto moves = h > T(0);
  FlightState<T, N> end;
  T elapsed, rest;
  const auto fallen = [&](const T& part) {
    elapsed = part * h;
    end = advance_flight(equations, at.s, elapsed).to;
    const T value = select(moves, T(-end[i] / fall), T(0));
    const T slope = select(moves, T(-equations.rates(end, h)[i] / fall), T(1));
    rest = -value / slope * h;
    return ValueAndSlope<T>{value, slope};
  };
  find_root(fallen, T(0), T(1), guess, T(precision));
  const FlightState<T, N> change = equations.rates(end, rest);
  at.time = select(moves, T(at.time + elapsed + rest), at.time);
  for (std::size_t j = 0; j < N; ++j) at.s[j] = select(moves, T(end[j] + change[j]), at.s[j]);
}

/// The limit of the steps of each leg of a flight, rejected steps included.
inline constexpr int max_flight_steps = 10'000;

/// Integrates until coordinate i, which has only one zero, has fallen to it. Lanes in which it is
/// not positive remain unchanged; those that reach the limit of steps become NaN. With derivatives
/// (N = 8), the apex, where coordinate 3 is zero, may be passed by the last step.
template <class T, std::size_t N>
void fly_until_zero(const Scene& scene, std::size_t i, double tolerance, FlightInstant<T, N>& at) {
  const FlightEquations<T> equations(scene);
  auto flies = at.s[i] > T(0);
  const T first = T(3 * std::pow(tolerance, 0.125)) * equations.time_scale(at.s);
  T h = select(flies, first, T(0)), fall = 1, guess = 0;
  // Only the height of the apex needs its location. A step must not reach the ground as well.
  const T passing_height = N == 8 ? 0 : std::numeric_limits<double>::infinity();
  for (int n = 0; n < max_flight_steps && any(flies); ++n) {
    const auto [to, error] = advance_flight(equations, at.s, h);
    const auto accepted = flies & (error <= T(tolerance));
    const auto passes = accepted & (to[i] <= T(0)) & (to[1] > passing_height);
    const auto falls = accepted & (to[i] <= T(0)) & !passes, proceeds = accepted & !falls;
    if (any(falls)) {
      fall = select(falls, T(at.s[i] - to[i]), fall);
      const T zero = zero_of_cubic<T>({at.s[i], equations.rates(at.s, h)[i]},
                                      {to[i], equations.rates(to, h)[i]});
      guess = select(falls, zero, guess);
    }
    flies = flies & !falls & !passes;
    at.time = select(proceeds, T(at.time + h), at.time);
    for (std::size_t j = 0; j < N; ++j) at.s[j] = select(proceeds, to[j], at.s[j]);
    T next = h * step_factor(ErrorRatio<T>{error, T(tolerance)}, 7);
    if (i == 3) {  // |u| u may turn sharply at the apex, between the stages of a long step
      const T limit = T(0.5) * equations.time_scale(at.s);
      next = select(next < limit, next, limit);
    }
    h = select(flies, next, select(passes, T(0), h));
  }
  set_nan(flies, at);
  h = select(flies, T(0), h);
  if (any(h > T(0))) fly_to_zero(equations, i, h, fall, guess, 0.1 * std::sqrt(tolerance), at);
}

/// Flies to the apex and then to the ground; returns the height of the apex, m. Both legs end where
/// a coordinate falls to its only zero, and a projectile that is at rest in the air is so between
/// them, where |u| u is not smooth.
template <class T, std::size_t N>
T fly_to_ground(const Scene& scene, double tolerance, FlightInstant<T, N>& at) {
  fly_until_zero(scene, 3, tolerance, at);
  const T apex = at.s[1];
  fly_until_zero(scene, 1, tolerance, at);
  return apex;
}

/// Integrates until `time` (s since the release), or until max_flight_steps are taken.
inline void fly_until(const Scene& scene, double time, double tolerance,
                      FlightInstant<double, 4>& at) {
  const FlightEquations<double> equations(scene);
  double h = time - at.time;
  for (int n = 0; n < max_flight_steps && at.time < time; ++n) {
    h = std::min({h, time - at.time, 0.5 * equations.time_scale(at.s)});
    const bool last = h == time - at.time;
    const auto [to, error] = advance_flight(equations, at.s, h);
    if (error <= tolerance) at = {last ? time : at.time + h, to};
    h *= step_factor(ErrorRatio<double>{error, tolerance}, 7);
  }
}

/// The start of a flight in state s; NaN where s is not finite, so that nothing is integrated
/// there.
template <class T, std::size_t N>
FlightInstant<T, N> release_into_air(const FlightState<T, N>& s) {
  T sum = 0;
  for (const T& coordinate : s) sum += coordinate;
  FlightInstant<T, N> at{T(0), s};
  set_nan(!is_finite_sum(sum), at);
  return at;
}

}  // namespace trebsweep
