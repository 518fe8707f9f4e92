#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/release_rule.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// Swings whose last step contains the lift-off. They wait until they fill a pack, so that root
/// finding is for all lanes at once, and then until lanes are free to continue them.
template <class Stepper, class T, Effects E>
class LiftOffQueue {
 public:
  using Number = typename Lanes<T>::Number;
  LiftOffQueue(const Solver& solver, const RecordRequest& request)
      : tolerance_(solver.tolerance), request_(request) {}

  /// The lanes whose projectile slides at the start of a step and would have to be pulled into the
  /// trough later in it: at the end of one of its parts, where the motion is interpolated. A
  /// shorter lack of force is not seen.
  LaneMask find(const Motion<T, E>& motion, const Instant<T, E>& from, const Instant<T, E>& to) {
    const auto sliding = motion.sliding() > T(0);
    if (lanes_of(sliding) == 0) return 0;
    constexpr int parts = parts_to_search<Stepper>;
    const Quintic<T, E> between(from, to, step_between(from, to));
    normal_ = motion.normal_force(to.x, to.directions);
    part_ = 1;
    for (int i = parts - 1; i > 0; --i) {
      const State<T, E> x = between(static_cast<double>(i) / parts);
      const T normal = motion.normal_force(x, directions<E>(x));
      part_ = select(normal <= T(0), T(static_cast<double>(i) / parts), part_);
      normal_ = select(normal <= T(0), normal, normal_);
    }
    return lanes_of((normal_ <= T(0)) & sliding);
  }

  /// Whether the sliding swing in a lane lifts off in the step last passed to find().
  bool finds(std::size_t lane) const { return get_lane(normal_, lane) <= Number(0); }

  /// Whether it does so before `limit`, within a fixed step that ends later.
  bool finds_before(const T& limit, std::size_t lane, Stepper& stepper, const Motion<T, E>& motion,
                    const Instant<T, E>& from) const {
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
            const LaneState<T, E>& state, const SwingRecord<T>& record, const Instant<T, E>& from,
            const Instant<T, E>& to) {
    auto& [swings, indices, all_steps, size] = waiting_;
    copy_lane<T>(swings.state, size, state, lane);
    copy_lane<T>(swings.record, size, record, lane);
    copy_lane<T>(swings.from, size, from, lane);
    copy_lane<T>(swings.to, size, to, lane);
    copy_lane<T>(swings.part, size, part_, lane);
    copy_lane<T>(swings.normal, size, normal_, lane);
    indices[size] = index;
    all_steps[size] = steps;
    ++size;
  }

  /// Locates the lift-offs of all swings that wait, and calls observe(from, to) with the ends of
  /// their last steps, which end there.
  template <class Observe>
  [[gnu::noinline]] void locate(Stepper& stepper, const Scene& scene, Observe observe) {
    if (waiting_.size == 0) return;
    for (std::size_t lane = waiting_.size; lane < lanes; ++lane)
      copy_lane<T>(waiting_.swings, lane, waiting_.swings, 0);
    auto& [state, record, from, to, part, normal] = waiting_.swings;
    to = lift_off_within(stepper, state.motion, from, T(to.t - from.t), part, normal, tolerance_);
    if constexpr (has_fields<T>) {
      const Mechanism<T, E> mechanism(scene, state.design);
      record = record_step(record, request_, stepper, tolerance_, state.motion, mechanism, from, to,
                           step_between(from, to));
    }
    record.lift_off_time = to.t;
    observe(from, to);
    state.motion.set_sliding(T(0));
    to = instant(state.motion, to.t, to.x);
    located_.push_back(waiting_);
    waiting_.size = 0;
  }

  /// A swing that continues in a lane, unless it has `ended` in its step before the lift-off.
  struct Continued {
    std::uint64_t index, steps;
    bool ended;
  };

  /// Moves a swing whose lift-off is located to a lane.
  Continued pop(const ReleaseRule<Number>& rule, std::size_t lane, LaneState<T, E>& state,
                SwingRecord<T>& record, Instant<T, E>& now) {
    Swings& last = located_.back();
    const std::size_t i = --last.size;
    copy_lane<T>(state, lane, last.swings.state, i);
    copy_lane<T>(record, lane, last.swings.record, i);
    copy_lane<T>(now, lane, last.swings.to, i);
    const Continued swing{last.indices[i], last.steps[i],
                          rule.ends_sliding(i, last.swings.from, last.swings.to)};
    if (i == 0) located_.pop_back();
    return swing;
  }

 private:
  static constexpr std::size_t lanes = Lanes<T>::count;

  struct Pending {
    LaneState<T, E> state;
    SwingRecord<T> record;
    Instant<T, E> from, to;
    T part, normal;  // see find()
  };
  struct Swings {
    Pending swings{};
    std::array<std::uint64_t, lanes> indices{}, steps{};
    std::size_t size = 0;
  };

  double tolerance_;
  RecordRequest request_;
  T part_{}, normal_{};
  Swings waiting_;
  std::vector<Swings> located_;
};

}  // namespace trebsweep
