#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/swing/best_release.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/release_rule.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// Swings whose last step contains an event from which they restart: the lift-off, or later a
/// turning point of phi1 - phi2 where the rule of release depends on that angle. They wait until
/// they fill a pack, so that root finding is for all lanes at once, and then until lanes are free
/// to continue them.
template <class Stepper, class T, Effects E>
class RestartQueue {
 public:
  using Number = typename Lanes<T>::Number;

  /// The swing in a lane of a full or partly filled pack.
  struct Pending {
    LaneState<T, E> state;
    SwingRecord<T> record;
    Instant<T, E> from, to;
    T part, value;  // see find()
  };

  RestartQueue(const Scene& scene, const Solver& solver, const RecordRequest& request)
      : scene_(scene), solver_(solver), rule_(solver), request_(request) {}

  /// The lanes whose step contains an event. A projectile lifts off where it would have to be
  /// pulled into the trough at the end of one of the step's parts, where the motion is
  /// interpolated: a shorter lack of force is not seen.
  LaneMask find(const Motion<T, E>& motion, const Instant<T, E>& from, const Instant<T, E>& to) {
    found_ = 0;
    if (rule_.is_of_sling()) {
      part_ = sling_turned_by(from, to);
      found_ = lanes_of(part_ > T(0));
      // Dry friction first stops an arm that turns back.
      if constexpr (E.pivot)
        if (scene_.pivot_friction > 0) found_ &= ~lanes_of(from.x[w1] * to.x[w1] < T(0));
    }
    if constexpr (E.trough) {
      const auto sliding = motion.sliding() > T(0);
      if (const LaneMask in_trough = lanes_of(sliding); in_trough != 0)
        found_ = (found_ & ~in_trough) | find_lift_offs(sliding, motion, from, to);
    }
    return found_;
  }

  /// Whether the step last passed to find() contains an event.
  bool finds(std::size_t lane) const { return (found_ >> lane & 1) != 0; }

  /// Whether a sliding swing lifts off before `limit`, within a fixed step that ends later.
  bool lifts_off_before(const T& limit, std::size_t lane, Stepper& stepper,
                        const Motion<T, E>& motion, const Instant<T, E>& from) const {
    Instant<T, E> at;
    State<T, E> no_error_estimate;
    advance(stepper, motion, from, T(limit - from.t), at, no_error_estimate);
    return get_lane(motion.normal_force(at.x, at.directions), lane) <= Number(0);
  }

  bool full() const { return waiting_.size == lanes; }
  bool empty() const { return waiting_.size == 0 && located_.empty(); }
  bool has_located() const { return !located_.empty(); }

  /// Adds the swing in a lane, which has taken `steps`, the last one from `from` to `to`.
  void push(std::size_t lane, std::uint64_t index, std::uint64_t steps,
            const LaneState<T, E>& state, const SwingRecord<T>& record,
            const BestRelease<T, E>& best, const Instant<T, E>& from, const Instant<T, E>& to) {
    auto& [swings, found, indices, all_steps, size] = waiting_;
    copy_lane<T>(swings.state, size, state, lane);
    copy_lane<T>(swings.record, size, record, lane);
    copy_lane<T>(swings.from, size, from, lane);
    copy_lane<T>(swings.to, size, to, lane);
    copy_lane<T>(swings.part, size, part_, lane);
    copy_lane<T>(swings.value, size, value_, lane);
    if (rule_.chooses()) found.copy(size, best, lane);
    indices[size] = index;
    all_steps[size] = steps;
    ++size;
  }

  /// Locates the events of all swings that wait, which become the ends of their last steps. Calls
  /// ends(lane, index, steps, pending, best) to learn which of them end with that step, and
  /// observe(from, to) for the others, which continue.
  template <class Ends, class Observe>
  [[gnu::noinline]] void locate(Stepper& stepper, Ends ends, Observe observe) {
    if (waiting_.size == 0) return;
    auto& [swings, best, indices, steps, size] = waiting_;
    for (std::size_t lane = size; lane < lanes; ++lane) copy_lane<T>(swings, lane, swings, 0);
    auto& [state, record, from, to, part, value] = swings;
    locate_events(stepper);
    for (std::size_t lane = size; lane-- > 0;)
      if (ends(lane, indices[lane], steps[lane], std::as_const(swings), std::as_const(best)))
        remove(lane);
    if (size == 0) return;

    const auto sliding = state.motion.sliding() > T(0);
    const Mechanism<T, E> mechanism(scene_, state.design);
    const T h = step_between(from, to);
    if (rule_.chooses())
      best.try_step(((LaneMask{1} << size) - 1) & ~lanes_of(sliding), solver_.release, state.motion,
                    mechanism, from, to, h, record);
    record = record_step(record, request_, stepper, solver_.tolerance, state.motion, mechanism,
                         from, to, h);
    if constexpr (E.trough) {
      record.lift_off_time = select(sliding, to.t, record.lift_off_time);
      record.projectile_clearance =
          select(sliding, T(scene_.trough_height), record.projectile_clearance);
    }
    observe(from, to);
    state.motion.set_sliding(T(0));
    to = instant(state.motion, to.t, to.x);
    located_.push_back(std::exchange(waiting_, Swings{}));
  }

  /// A swing that continues in a lane.
  struct Continued {
    std::uint64_t index, steps;
  };

  /// Moves a swing whose event is located to a lane.
  Continued pop(std::size_t lane, LaneState<T, E>& state, SwingRecord<T>& record,
                BestRelease<T, E>& best, Instant<T, E>& now) {
    Swings& last = located_.back();
    const std::size_t i = --last.size;
    copy_lane<T>(state, lane, last.swings.state, i);
    copy_lane<T>(record, lane, last.swings.record, i);
    copy_lane<T>(now, lane, last.swings.to, i);
    if (rule_.chooses()) best.copy(lane, last.best, i);
    const Continued swing{last.indices[i], last.steps[i]};
    if (i == 0) located_.pop_back();
    return swing;
  }

 private:
  static constexpr std::size_t lanes = Lanes<T>::count;

  struct Swings {
    Pending swings{};
    BestRelease<T, E> best;
    std::array<std::uint64_t, lanes> indices{}, steps{};
    std::size_t size = 0;
  };

  template <class Mask>
  LaneMask find_lift_offs(const Mask& sliding, const Motion<T, E>& motion,
                          const Instant<T, E>& from, const Instant<T, E>& to) {
    constexpr int parts = parts_to_search<Stepper>;
    const Quintic<T, E> between(from, to, step_between(from, to));
    T normal = motion.normal_force(to.x, to.directions), part = 1;
    for (int i = parts - 1; i > 0; --i) {
      const State<T, E> x = between(static_cast<double>(i) / parts);
      const T force = motion.normal_force(x, directions<E>(x));
      part = select(force <= T(0), T(static_cast<double>(i) / parts), part);
      normal = select(force <= T(0), force, normal);
    }
    part_ = select(sliding, part, part_);
    value_ = select(sliding, T(-normal), T(0));
    return lanes_of((normal <= T(0)) & sliding);
  }

  /// Makes the located events the ends of the steps.
  ///
  /// As accelerations are continuous, an error of the lift-off's time changes the swing by its
  /// square only, as does one of a turning point the angle there: root finding stops within
  /// sqrt(eps) of the root (as a fraction of the step) or, if that is less, 100 times the tolerance
  /// of the steps.
  void locate_events(Stepper& stepper) {
    using std::abs;
    auto& [state, record, from, to, part, value] = waiting_.swings;
    const Motion<T, E>& motion = state.motion;
    const auto epsilon = static_cast<double>(std::numeric_limits<Number>::epsilon());
    const auto rate = [](const Instant<T, E>& at) { return T(at.x[w1] - at.x[w2]); };
    const auto bend = [](const Instant<T, E>& at) { return T(at.dxdt[w1] - at.dxdt[w2]); };
    const T first = select(abs(rate(from)) > T(0), rate(from), bend(from));
    const T sign = select(first < T(0), T(1), T(-1));
    const auto sliding = motion.sliding() > T(0);
    const auto beyond = [&](const Instant<T, E>& at) {
      const T turned = sign * rate(at);
      if constexpr (!E.trough) return turned;
      return select(sliding, T(-motion.normal_force(at.x, at.directions)), turned);
    };
    const T h = to.t - from.t, start = beyond(from);
    const T end = select(sliding, value, T(part * h * sign * bend(from) + start));
    const T slope = T(abs(T(end - start)) / part);
    const Bracket<T, E> bracket{from, h, T(0), part, T(-start / slope), slope};
    to = root_in(bracket, stepper, motion, beyond,
                 std::min(std::sqrt(epsilon), 100 * solver_.tolerance));
    // Without a rate, the next step does not turn at its start again.
    const T scale = T(1e3 * epsilon) * T(abs(to.x[w1]) + abs(to.x[w2]));
    const auto turns = !sliding & (abs(rate(to)) <= scale);
    to.x[w2] = select(turns, to.x[w1], to.x[w2]);
  }

  /// Removes a swing that waits.
  void remove(std::size_t lane) {
    auto& [swings, best, indices, steps, size] = waiting_;
    const std::size_t last = --size;
    copy_lane<T>(swings, lane, swings, last);
    if (rule_.chooses()) best.copy(lane, best, last);
    indices[lane] = indices[last];
    steps[lane] = steps[last];
  }

  const Scene scene_;
  const Solver solver_;
  const ReleaseRule<Number> rule_;
  const RecordRequest request_;
  LaneMask found_ = 0;
  T part_{}, value_{};  // of each lane, the fraction of the step by which its event has happened,
                        // and of a lift-off the force that is lacking there
  Swings waiting_;
  std::vector<Swings> located_;
};

}  // namespace trebsweep
