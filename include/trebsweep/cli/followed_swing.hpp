#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/flight.hpp"
#include "trebsweep/swing/load_samples.hpp"
#include "trebsweep/swing/peak.hpp"
#include "trebsweep/swing/swing.hpp"

namespace trebsweep {

/// The least value of a quantity along a swing, and when (s) it is; infinite if it has none.
struct Least {
  double value = std::numeric_limits<double>::infinity();
  double t = std::numeric_limits<double>::quiet_NaN();

  void add(double other, double time) {
    if (other < value) *this = {other, time};
  }
};

/// Least tensions (N) and heights above the ground (m), those of the projectile from its lift-off
/// on: the fields of a sweep, also for a swing without a release.
struct LeastLoads {
  Least sling_tension, hanger_tension, tip_height, counterweight_height, projectile_height;

  BuildValues build_values() const {
    return {sling_tension.value, hanger_tension.value, tip_height.value, counterweight_height.value,
            projectile_height.value};
  }

  void set_values(const BuildValues& values) {
    sling_tension.value = values.least_sling_tension;
    hanger_tension.value = values.least_hanger_tension;
    tip_height.value = values.tip_clearance;
    counterweight_height.value = values.counterweight_clearance;
    projectile_height.value = values.projectile_clearance;
  }

  /// The body that comes lowest, and its least height.
  std::pair<std::string_view, Least> lowest() const {
    using Body = std::pair<std::string_view, Least>;
    return std::min({Body("tip", tip_height), Body("counterweight", counterweight_height),
                     Body("projectile", projectile_height)},
                    [](const Body& a, const Body& b) { return a.second.value < b.second.value; });
  }
};

/// A swing from the start to its end.
template <Effects E>
struct FollowedSwing {
  Outcome<double, E> outcome;
  std::optional<double> lift_off;  ///< when the projectile leaves the trough, if it does (s)
  LeastLoads least;
};

/// An observer that follows the projectile out of the trough and finds the least loads.
template <Effects E>
class Follower {
 public:
  Follower(const Job& job, const Design<double>& design)
      : motion_(job.scene, design),
        mechanism_(job.scene, design),
        advance_(make_advance<E>(job.scene, design, job.solver)) {
    end_ = instant(motion_, 0, start<double, E>(job.scene, design));
    if (E.trough && normal_force(end_) <= 0) lift_off();
    add(loads_at(motion_, mechanism_, end_), 0);
  }

  void operator()(const Instant<double, E>& from, const Instant<double, E>& to) {
    // Polynomials over parts of long steps give the times of least values to 1e-4 s.
    const int parts = static_cast<int>(std::clamp((to.t - from.t) / 5e-3, 1.0, 4.0));
    if (to.t > from.t)
      for (int part = 0; part < parts; ++part) add_part(from, to, part, parts);
    end_ = to;
    // The last step in the trough ends with the lift-off, where the normal force is zero up to the
    // precision of root finding.
    if (E.trough && !lift_off_) {
      const double weight = mechanism_.scene().projectile_mass * mechanism_.scene().gravity;
      if (normal_force(to) <= 1e-6 * (weight + normal_force(from))) lift_off();
    }
  }

  /// The swing, whose last step is not observed if it has no release.
  FollowedSwing<E> finish(const Outcome<double, E>& outcome) {
    if (outcome.t > end_.t) (*this)(end_, instant(motion_, outcome.t, outcome.x));
    if (outcome.status == Status::never_lifted) {  // it ends before the lift-off
      lift_off_.reset();
      least_.projectile_height = {};
    }
    return {outcome, lift_off_, least_};
  }

 private:
  double normal_force(const Instant<double, E>& at) const {
    return motion_.normal_force(at.x, at.directions);
  }

  /// The projectile leaves the trough, at the end of the last step.
  void lift_off() {
    lift_off_ = end_.t;
    motion_.set_sliding(0);
    end_ = instant(motion_, end_.t, end_.x);
    least_.projectile_height.add(mechanism_.scene().trough_height, end_.t);
  }

  /// Adds the loads of one of the equal parts of a step.
  void add_part(const Instant<double, E>& from, const Instant<double, E>& to, int part, int parts) {
    const double h = (to.t - from.t) / parts;
    const auto time = [&](double node) { return from.t + (part + node) * h; };
    const auto loads = [&](double node) {
      if (part == 0 && node == 0) return loads_at(motion_, mechanism_, from);
      const bool is_end = part + 1 == parts && node == 1;
      // Where an event ends the step, its state has been extrapolated, but not its rates.
      const auto at =
          is_end ? instant(motion_, to.t, to.x) : advance_(motion_, from, (part + node) * h);
      return loads_at(motion_, mechanism_, at);
    };
    LoadSamples<double> samples;
    for (std::size_t i = 0; i < load_nodes.size(); ++i) {
      samples[i] = loads(load_nodes[i]);
      add(samples[i], time(load_nodes[i]));
    }
    for (double Loads<double>::*load :
         {&Loads<double>::projectile_tension, &Loads<double>::hanger_tension,
          &Loads<double>::tip_height, &Loads<double>::counterweight_height,
          &Loads<double>::projectile_height}) {
      std::array<double, load_nodes.size()> negative;
      std::ranges::transform(samples, negative.begin(), [&](const auto& l) { return -(l.*load); });
      const double node = peak(load_nodes, negative).at;
      if (std::ranges::count(load_nodes, node) == 0) add(loads(node), time(node));
    }
  }

  void add(const Loads<double>& loads, double t) {
    least_.sling_tension.add(loads.projectile_tension, t);
    least_.hanger_tension.add(loads.hanger_tension, t);
    least_.tip_height.add(loads.tip_height, t);
    least_.counterweight_height.add(loads.counterweight_height, t);
    if (E.trough) {
      // So far below the trough, rounding errors just after the lift-off do not count.
      const double lowest = mechanism_.scene().trough_height - ground_rounding;
      if (motion_.sliding() > 0 || loads.projectile_height > lowest) return;
    }
    least_.projectile_height.add(loads.projectile_height, t);
  }

  Motion<double, E> motion_;
  const Mechanism<double, E> mechanism_;
  Advance<E> advance_;
  Instant<double, E> end_;
  std::optional<double> lift_off_;
  LeastLoads least_;
};

/// Integrates a swing. Where it has a release, the least values are those of the fields, and only
/// their times are found here. `fields` are computed as well, for the status that they give.
template <Effects E>
FollowedSwing<E> follow_swing(const Job& job, const Design<double>& design,
                              std::span<const Field> fields) {
  std::vector<Field> all(build_fields.begin(), build_fields.end());
  all.insert(all.end(), fields.begin(), fields.end());
  std::vector<double> values(all.size());
  Follower<E> follower(job, design);
  const auto outcome = swing<E>(job.scene, design, job.solver, std::ref(follower), all, values);
  FollowedSwing<E> followed = follower.finish(outcome);
  if (has_speed(outcome.status)) followed.least.set_values(to_build_values(values));
  return followed;
}

}  // namespace trebsweep
