#include "trebsweep/trace.hpp"

#include <fmt/format.h>

#include <cmath>

#include "trebsweep/number.hpp"

namespace trebsweep {
namespace {

constexpr double default_interval = 0.01;
constexpr double most_rows = 1e7;

void print_header(std::FILE* out) {
  fmt::print(out, "t phi1 phi2 w1 w2 x1 y1 xt yt x3 y3 speed energy tension\n");
}

void print_row(const Motion<double>& motion, const Instant<double>& at, std::FILE* out) {
  const auto counterweight = motion.counterweight(at.x);
  const auto tip = motion.arm_tip(at.x);
  const auto projectile = motion.projectile(at.x);
  fmt::print(
      out,
      "{:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} "
      "{:.10g} {:.12g} {:.10g}\n",
      at.t, at.x[phi1], at.x[phi2], at.x[w1], at.x[w2], counterweight.x, counterweight.y, tip.x,
      tip.y, projectile.x, projectile.y, motion.speed(at.x), motion.energy(at.x),
      motion.sling_tension(at.x, at.dxdt));
}

/// An observer of a swing that prints the rows due in each step, and remembers its end.
template <class Stepper>
class Printer {
 public:
  Printer(const Motion<double>& motion, std::optional<double> interval, std::FILE* out)
      : motion_(motion), interval_(interval), out_(out) {}

  void operator()(const Instant<double>& from, const Instant<double>& to) {
    if (row_ == 0) print(from);
    if (!interval_) return print(to);
    // Rows that fall on a step's end but for rounding are the step's end.
    const double rounding = 1e-9 * *interval_;
    for (double t = due(); t <= to.t + rounding; t = due())
      print(std::abs(t - to.t) <= rounding ? to : after(from, t - from.t));
  }

  /// Prints the last moment, if no row fell on it.
  void finish(const Outcome<double>& outcome) {
    if (row_ > 0 && outcome.t <= printed_) return;
    print(instant(motion_, outcome.t, outcome.x));
  }

 private:
  double due() const { return static_cast<double>(row_) * *interval_; }

  Instant<double> after(const Instant<double>& from, double h) {
    Instant<double> to;
    State<double> error;
    advance(stepper_, motion_, from, h, to, error);
    return to;
  }

  void print(const Instant<double>& at) {
    print_row(motion_, at, out_);
    printed_ = at.t;
    ++row_;
  }

  const Motion<double>& motion_;
  Stepper stepper_;
  std::optional<double> interval_;
  std::FILE* out_;
  std::uint64_t row_ = 0;
  double printed_ = 0;
};

}  // namespace

Status trace(const Job& job, const Design<double>& design, std::optional<double> interval,
             std::FILE* out) {
  if (!start_is_reachable(job.scene, design.r1))
    refuse("r1", fmt::format("{}", design.r1),
           fmt::format("at least |h - h0| = {:.6g} m, to hold the counterweight at its height",
                       std::abs(job.scene.release_height - job.scene.fulcrum_height)));
  const double shortest = job.solver.max_time / most_rows;
  if (interval && *interval < shortest)
    refuse(
        "interval", fmt::format("{}", *interval),
        fmt::format("at least {:g} s, which makes {:g} rows up to max-time", shortest, most_rows));
  return with_stepper(job.solver.stepper, [&]<template <class> class Stepper>() {
    if (!interval && is_adaptive<Stepper<double>>) interval = default_interval;
    const Motion<double> motion(job.scene, design);
    Printer<Stepper<double>> printer(motion, interval, out);
    print_header(out);
    const auto outcome = swing<Stepper<double>, double>(job.scene, design, job.solver, printer);
    printer.finish(outcome);
    return outcome.status;
  });
}

}  // namespace trebsweep
