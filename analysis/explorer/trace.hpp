#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

#include "integration.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/load_samples.hpp"

namespace trebsweep::explorer {

/// A row of a trace; the units are those of `trebsweep trace`.
struct Row {
  double t, phi1, phi2, phi3, x1, y1, xh, yh, xt, yt, x3, y3, speed, energy, tension, tip_tension,
      axle, stress, hanger_tension, normal;
};
inline constexpr std::string_view row_names =
    "t phi1 phi2 phi3 x1 y1 xh yh xt yt x3 y3 speed energy tension tip_tension axle stress "
    "hanger_tension normal";
inline constexpr std::size_t max_rows = 1000;
inline std::array<Row, max_rows> rows;

/// A row of a flight: position and velocity relative to the foot of the fulcrum.
struct FlightRow {
  double t, x, height, vx, vy;
};
inline constexpr std::string_view flight_row_names = "t x height vx vy";
inline std::array<FlightRow, max_rows> flight_rows;
inline std::size_t flight_row_count;

template <Effects E>
Row row(const Motion<Number, E>& motion, const Mechanism<Number, E>& mechanism,
        const Moment<E>& at) {
  const auto& [t, x, directions, dxdt] = at;
  const auto loads = loads_at(motion, mechanism, at);
  const auto weight = mechanism.counterweight(x), tip = mechanism.arm_tip(x);
  const auto hinge = Number(-mechanism.design().r1 / mechanism.design().r2) * tip;
  const auto projectile = mechanism.projectile(x);
  const Number angle3 = E.hanger ? x[phi3] : Number(0);
  return {t[0],
          x[phi1][0],
          x[phi2][0],
          angle3[0],
          weight.x[0],
          weight.y[0],
          hinge.x[0],
          hinge.y[0],
          tip.x[0],
          tip.y[0],
          projectile.x[0],
          projectile.y[0],
          mechanism.speed(x)[0],
          mechanism.energy(x)[0],
          loads.projectile_tension[0],
          loads.tip_tension[0],
          loads.axle[0],
          std::abs(loads.beam_stress[0]),
          loads.hanger_tension[0],
          motion.normal_force(x, directions)[0]};
}

/// By the rules that choose the release from an interval, steps beyond it are observed before it;
/// removes them.
template <Effects E>
void keep_steps_before_release(std::vector<Step<E>>& steps) {
  const Step<E> last = steps.back();
  std::erase_if(steps, [&](const Step<E>& step) { return step.from.t[0] >= last.from.t[0]; });
  steps.push_back(last);
}

/// The time of the lift-off from the trough, s; infinite without one. The last step in the trough
/// ends with the lift-off, where the force is zero up to rounding.
template <Effects E>
double lift_off_time(const Motion<Number, E>& sliding, const std::vector<Step<E>>& steps) {
  const auto force = [&](const Moment<E>& at) {
    return sliding.normal_force(at.x, at.directions)[0];
  };
  const double weight = scene.projectile_mass * scene.gravity;
  for (const auto& [from, to] : steps) {
    if (force(from) <= 0) return from.t[0];
    if (force(to) <= 1e-6 * (weight + force(from))) return to.t[0];
  }
  return std::numeric_limits<double>::infinity();
}

/// Sets flight_rows to the flight from a release in state x at time t.
template <Effects E>
void trace_flight(const Mechanism<Number, E>& mechanism, double t, const State<Number, E>& x) {
  constexpr double tolerance = 1e-12;
  const auto position = mechanism.projectile(x), velocity = mechanism.velocity(x);
  auto at = release_into_air<double, 4>(
      {position.x[0], flight_height(scene, position)[0], velocity.x[0], velocity.y[0]});
  auto impact = at;
  fly_to_ground(scene, tolerance, impact);
  if (!std::isfinite(impact.time)) return;
  constexpr std::size_t count = 200;
  for (std::size_t i = 0; i < count; ++i) {
    if (i + 1 == count)
      at = impact;
    else
      fly_until(scene, impact.time * static_cast<double>(i) / (count - 1), tolerance, at);
    flight_rows[flight_row_count++] = {t + at.time, at.s[0], at.s[1], at.s[2], at.s[3]};
  }
}

/// Integrates a batch of a single design, and sets `rows` to its swing at equal intervals and
/// flight_rows to its flight, if it has one. Returns the number of rows.
template <Effects E>
std::size_t trace_swing(const Batch& batch) {
  std::vector<Step<E>> steps;
  integrate_batch<E>(batch, &steps);
  flight_row_count = 0;
  if (steps.empty()) return 0;
  if (takes_best_moment(solver.release)) keep_steps_before_release(steps);
  const auto& [r1, r3, r2] = batch.designs[0];
  const Design<Number> design{r1, r3, r2};
  Motion<Number, E> motion(scene, design);
  const Mechanism<Number, E> mechanism(scene, design);
  const double lift_off = E.trough ? lift_off_time(motion, steps) : 0;
  const auto stepper = make_stepper<E>();
  const double end = steps.back().to.t[0];
  const auto count =
      static_cast<std::size_t>(std::clamp(end / 0.0025, 200.0, static_cast<double>(max_rows)));
  auto step = steps.begin();
  for (std::size_t i = 0; i < count; ++i) {
    const double t = end * static_cast<double>(i) / static_cast<double>(count - 1);
    while (step + 1 != steps.end() && t > step->to.t[0]) ++step;
    const double start = step->from.t[0];
    motion.set_sliding(start < lift_off ? 1 : 0);
    Moment<E> at = step->from;
    State<Number, E> error;
    if (t > start) advance(stepper, motion, step->from, Number(t - start), at, error);
    rows[i] = row(motion, mechanism, at);
  }
  if (has_speed(batch.results[0].status)) trace_flight(mechanism, end, steps.back().to.x);
  return count;
}

}  // namespace trebsweep::explorer
