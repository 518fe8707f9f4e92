#include "trebsweep/cli/trace.hpp"

#include <fmt/format.h>

#include <cmath>

#include "trebsweep/base/error.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/swing/load_samples.hpp"
#include "trebsweep/swing/swing.hpp"

namespace trebsweep {
namespace {

constexpr double default_interval = 0.01;
constexpr double max_rows = 1e7;

/// analysis/trajectory.py takes the ground and the flight from the comments.
void print_header(const Job& job, std::FILE* out) {
  const Solver& solver = job.solver;
  fmt::print(out, "# gravity = {}\n# fulcrum-height = {}\n# release = {}\n", job.scene.gravity,
             job.scene.fulcrum_height, release_names[static_cast<std::size_t>(solver.release)]);
  if (solver.release == Release::window)
    fmt::print(out, "# release-window = {}\n", solver.release_window);
  fmt::print(out,
             "t phi1 phi2 w1 w2 x1 y1 xt yt x3 y3 speed energy tension tip_tension axle stress\n");
}

template <Effects E>
void print_row(const Motion<double, E>& motion, const Mechanism<double, E>& mechanism,
               const Instant<double, E>& at, std::FILE* out) {
  const auto counterweight = mechanism.counterweight(at.x);
  const auto tip = mechanism.arm_tip(at.x);
  const auto projectile = mechanism.projectile(at.x);
  const auto loads = loads_at(motion, mechanism, at);
  fmt::print(out,
             "{:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} "
             "{:.10g} {:.10g} {:.12g} {:.10g} {:.10g} {:.10g} {:.10g}\n",
             at.t, at.x[phi1], at.x[phi2], at.x[w1], at.x[w2], counterweight.x, counterweight.y,
             tip.x, tip.y, projectile.x, projectile.y, mechanism.speed(at.x),
             mechanism.energy(at.x), loads.projectile_tension, loads.tip_tension, loads.axle,
             std::abs(loads.beam_stress));
}

/// An observer that prints the rows within each step.
template <Effects E>
class Printer {
 public:
  Printer(const Job& job, const Design<double>& design, std::optional<double> interval,
          std::FILE* out)
      : motion_(job.scene, design),
        mechanism_(job.scene, design),
        advance_(make_advance<double, E>(job.solver)),
        interval_(interval),
        out_(out) {}

  void operator()(const Instant<double, E>& from, const Instant<double, E>& to) {
    if (row_ == 0) print(from);
    if (!interval_) return print(to);
    // A row at the end of a step, up to rounding, is the end of the step.
    const double rounding = 1e-9 * *interval_;
    for (double t = due(); t <= to.t + rounding; t = due())
      print(std::abs(t - to.t) <= rounding ? to : advance_(motion_, from, t - from.t));
  }

  /// Prints the end of the swing, unless the last row is there.
  void finish(const Outcome<double, E>& outcome) {
    if (row_ > 0 && outcome.t <= printed_) return;
    print(instant(motion_, outcome.t, outcome.x));
  }

 private:
  double due() const { return static_cast<double>(row_) * *interval_; }

  void print(const Instant<double, E>& at) {
    print_row(motion_, mechanism_, at, out_);
    printed_ = at.t;
    ++row_;
  }

  Motion<double, E> motion_;
  Mechanism<double, E> mechanism_;
  Advance<double, E> advance_;
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
  const double shortest = job.solver.max_time / max_rows;
  if (interval && *interval < shortest)
    refuse(
        "interval", fmt::format("{}", *interval),
        fmt::format("at least {:g} s, which makes {:g} rows up to max-time", shortest, max_rows));
  return with_effects(job.scene, [&]<Effects E>() {
    if (!interval && follows_tolerance(job.solver.stepper)) interval = default_interval;
    Printer<E> printer(job, design, interval, out);
    print_header(job, out);
    const auto outcome = swing<E>(job.scene, design, job.solver, std::ref(printer));
    printer.finish(outcome);
    return outcome.status;
  });
}

}  // namespace trebsweep
