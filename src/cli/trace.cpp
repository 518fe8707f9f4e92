#include "trebsweep/cli/trace.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "trebsweep/base/error.hpp"
#include "trebsweep/cli/followed_swing.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/load_samples.hpp"
#include "trebsweep/swing/swing.hpp"

namespace trebsweep {
namespace {

constexpr double default_interval = 0.01;
constexpr double max_rows = 1e7;
constexpr double flight_tolerance = 1e-13;

void check_start(const Scene& scene, const Design<double>& design) {
  if (!start_is_reachable(scene, design)) {
    const std::string arm = scene.start_tip_height ? "r2" : "r1";
    const char* const height = scene.start_tip_height           ? "h0 - start-tip-height"
                               : scene.counterweight_hanger > 0 ? "h - h0 + r4"
                                                                : "h - h0";
    refuse(arm, fmt::format("{}", start_arm(scene, design)),
           fmt::format("at least |{}| = {:.6g} m, to {}", height, std::abs(start_height(scene)),
                       scene.start_tip_height ? "reach from the fulcrum to the tip's height"
                                              : "hold the counterweight at its height"));
  }
  if (!sling_reaches_trough(scene, design))
    refuse("r3", fmt::format("{}", design.r3),
           fmt::format("at least {:.6g} m, to reach the trough from the tip of the throwing arm",
                       std::abs(start_above_trough(scene, design))));
}

/// Refuses an interval that makes too many rows over a duration (s), named for the message.
void check_interval(std::optional<double> interval, double duration, std::string_view name) {
  const double shortest = duration / max_rows;
  if (interval && *interval < shortest)
    refuse(
        "interval", fmt::format("{}", *interval),
        fmt::format("at least {:g} s, which makes {:g} rows up to {}", shortest, max_rows, name));
}

/// A least value, and when (s) it is.
void print_least(std::string_view key, const Least& least, std::FILE* out) {
  fmt::print(out, "# {} = {:.12g}\n# {}-time = {:.12g}\n", key, least.value, key, least.t);
}

/// The comments above the header, from which analysis/trajectory.py draws ground, trough, lift-off
/// and release. The least values are those of a sweep's fields of the same names.
template <Effects E>
void print_comments(const Job& job, const FollowedSwing<E>& swing, std::FILE* out) {
  const Scene& scene = job.scene;
  const Solver& solver = job.solver;
  fmt::print(out, "# fulcrum-height = {}\n", scene.fulcrum_height);
  if (scene.trough) fmt::print(out, "# trough-height = {}\n", scene.trough_height);
  fmt::print(out, "# release = {}\n", release_names[static_cast<std::size_t>(solver.release)]);
  if (solver.release == Release::crossing)
    fmt::print(out, "# release-angle = {}\n", solver.release_angle);
  if (solver.release == Release::window)
    fmt::print(out, "# release-window = {}\n", solver.release_window);
  if (solver.release == Release::pin)
    fmt::print(out, "# pin-angle = {}\n", solver.pin_angle.value());
  if (swing.lift_off) fmt::print(out, "# lift-off-time = {:.12g}\n", *swing.lift_off);
  if (has_speed(swing.outcome.status))
    fmt::print(out, "# release-time = {:.12g}\n", swing.outcome.t);
  const auto [body, height] = swing.least.lowest();
  print_least("ground-clearance", height, out);
  fmt::print(out, "# ground-clearance-of = {}\n", body);
  print_least("least-sling-tension", swing.least.sling_tension, out);
  if (E.hanger) print_least("least-hanger-tension", swing.least.hanger_tension, out);
}

/// The names and values of a row, from left to right.
using Row = std::vector<std::pair<std::string_view, double>>;

void print_header(const Row& row, std::FILE* out) {
  const char* separator = "";
  for (const auto& [name, value] : row) {
    fmt::print(out, "{}{}", separator, name);
    separator = " ";
  }
  fmt::print(out, "\n");
}

void print_values(const Row& row, std::FILE* out) {
  const char* separator = "";
  for (const auto& [name, value] : row) {
    fmt::print(out, "{}{:.12g}", separator, value);
    separator = " ";
  }
  fmt::print(out, "\n");
}

template <Effects E>
Row swing_row(const Motion<double, E>& motion, const Mechanism<double, E>& mechanism,
              const Instant<double, E>& at) {
  const Scene& scene = mechanism.scene();
  const auto& [t, x, directions, dxdt] = at;
  const auto loads = loads_at(motion, mechanism, at);
  Row row{{"t", t}, {"phi1", x[phi1]}, {"phi2", x[phi2]}, {"w1", x[w1]}, {"w2", x[w2]}};
  const auto add = [&](std::string_view name, double value) { row.emplace_back(name, value); };
  const auto add_point = [&](std::string_view name_x, std::string_view name_y,
                             const Vector<double>& point) {
    add(name_x, point.x);
    add(name_y, point.y);
  };
  if constexpr (E.hanger) {
    add("phi3", x[phi3]);
    add("w3", x[w3]);
  }
  const Vector<double> tip = mechanism.arm_tip(x);
  add_point("x1", "y1", mechanism.counterweight(x));
  if constexpr (E.hanger)
    add_point("xh", "yh", -mechanism.design().r1 / mechanism.design().r2 * tip);
  add_point("xt", "yt", tip);
  add_point("x3", "y3", mechanism.projectile(x));
  add("speed", mechanism.speed(x));
  add("energy", mechanism.energy(x));
  add("tension", loads.projectile_tension);
  add("tip_tension", loads.tip_tension);
  add("axle", loads.axle);
  if (has_beam_stress(scene)) add("stress", std::abs(loads.beam_stress));
  if constexpr (E.hanger) add("hanger_tension", loads.hanger_tension);
  if constexpr (E.trough) add("normal", motion.normal_force(x, directions));
  return row;
}

/// An observer that prints the rows within each step.
template <Effects E>
class Printer {
 public:
  Printer(const Job& job, const Design<double>& design, std::optional<double> interval,
          std::optional<double> lift_off, std::FILE* out)
      : motion_(job.scene, design),
        mechanism_(job.scene, design),
        advance_(make_advance<E>(job.scene, design, job.solver)),
        interval_(interval),
        lift_off_(lift_off),
        out_(out) {}

  void operator()(const Instant<double, E>& from, const Instant<double, E>& to) {
    continue_from(from.t);
    if (row_ == 0) print(from);
    if (!interval_) return print(to);
    // A row at the end of a step, up to rounding, is the end of the step.
    const double rounding = 1e-9 * *interval_;
    for (double t = due(); t <= to.t + rounding; t = due())
      print(std::abs(t - to.t) <= rounding ? to : advance_(motion_, from, t - from.t));
  }

  /// Prints the end of the swing, unless the last row is there.
  void finish(const Outcome<double, E>& outcome) {
    if (row_ > 0 && (outcome.t <= printed_ || !std::isfinite(outcome.t))) return;
    continue_from(outcome.t);
    print(instant(motion_, outcome.t, outcome.x));
  }

 private:
  double due() const { return static_cast<double>(row_) * *interval_; }

  /// Selects the motion, in the trough or free, after a time (s).
  void continue_from(double t) { motion_.set_sliding(lift_off_ && t >= *lift_off_ ? 0 : 1); }

  void print(const Instant<double, E>& at) {
    const Row row = swing_row(motion_, mechanism_, at);
    if (row_ == 0) print_header(row, out_);
    print_values(row, out_);
    printed_ = at.t;
    ++row_;
  }

  Motion<double, E> motion_;
  Mechanism<double, E> mechanism_;
  Advance<E> advance_;
  std::optional<double> interval_, lift_off_;
  std::FILE* out_;
  std::uint64_t row_ = 0;
  double printed_ = 0;
};

Row flight_row(const Scene& scene, double release_time, const FlightInstant<double, 4>& at) {
  const auto& [x, height, vx, vy] = at.s;
  return {{"t", release_time + at.time},
          {"x3", x},
          {"y3", height - scene.fulcrum_height},
          {"vx", vx},
          {"vy", vy},
          {"speed", std::hypot(vx, vy)}};
}

FlightInstant<double, 4> impact_after(const Scene& scene, FlightInstant<double, 4> at) {
  fly_to_ground(scene, flight_tolerance, at);
  if (!std::isfinite(at.time))
    throw std::runtime_error(
        fmt::format("the flight does not reach the ground within {} steps", max_flight_steps));
  return at;
}

template <Effects E>
Traced traced(const Scene& scene, const FollowedSwing<E>& swing) {
  return {swing.outcome.status, build_problems(scene, swing.least.build_values())};
}

}  // namespace

Traced trace(const Job& job, const Design<double>& design, std::optional<double> interval,
             std::FILE* out) {
  check_start(job.scene, design);
  check_interval(interval, job.solver.max_time, "max-time");
  return with_general_effects(job.scene, [&]<Effects E>() {
    if (!interval && follows_tolerance(job.solver.stepper)) interval = default_interval;
    // Once for the comments, and again for the rows below them.
    const auto events = follow_swing<E>(job, design, {});
    print_comments(job, events, out);
    Printer<E> printer(job, design, interval, events.lift_off, out);
    swing<E>(job.scene, design, job.solver, std::ref(printer));
    printer.finish(events.outcome);
    return traced(job.scene, events);
  });
}

Traced trace_flight(const Job& job, const Design<double>& design, std::optional<double> interval,
                    std::FILE* out) {
  const Scene& scene = job.scene;
  check_start(scene, design);
  return with_general_effects(scene, [&]<Effects E>() {
    constexpr std::array fields{Field::range};  // a release below the ground then has its status
    const auto events = follow_swing<E>(job, design, fields);
    const Outcome<double, E>& end = events.outcome;
    const auto print_row = [&](const FlightInstant<double, 4>& at) {
      print_values(flight_row(scene, end.t, at), out);
    };
    const auto print_above_rows = [&] {
      print_comments(job, events, out);
      print_header(flight_row(scene, 0, {}), out);
    };
    if (end.status != Status::released) {
      print_above_rows();
      return traced(scene, events);
    }

    const Mechanism<double, E> mechanism(scene, design);
    const auto position = mechanism.projectile(end.x), velocity = mechanism.velocity(end.x);
    FlightInstant<double, 4> at{
        0, {position.x, flight_height(scene, position), velocity.x, velocity.y}};
    const auto impact = impact_after(scene, at);
    check_interval(interval, impact.time, "the impact");
    print_above_rows();
    for (double row = 1; at.time < impact.time * (1 - 1e-12); ++row) {
      print_row(at);
      fly_until(scene, row * interval.value_or(default_interval), flight_tolerance, at);
    }
    print_row(impact);
    return traced(scene, events);
  });
}

}  // namespace trebsweep
