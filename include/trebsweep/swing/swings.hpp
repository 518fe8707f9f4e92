#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "trebsweep/swing/releases.hpp"
#include "trebsweep/swing/start_queue.hpp"
#include "trebsweep/swing/turns.hpp"

namespace trebsweep {

/// An observer that does nothing.
struct NullObserver {
  explicit constexpr operator bool() const { return false; }
  template <class Instant>
  void operator()(const Instant&, const Instant&) const {}
};

/// Integrates designs from rest to the event that ends their swing: one design per lane of T, each
/// with its own time and step length. When a swing ends, its lane starts the next design.
///
/// next(design) sets the next design, or returns false after the last one. done(index, outcome)
/// receives the outcomes in any order; designs are numbered in the order of next(). If design n has
/// a release, values[n * fields.size() + i] is set to fields[i] if that is_of_swing(). If `observe`
/// is true, there is a single design, which is in the first lane, and observe(from, to) is called
/// with the ends of every accepted step, except the last one of a swing without a release, and of
/// the step that ends at the release; rules that choose it have observed steps beyond it before.
template <class T, Effects E, class Next, class Done, class Observe = NullObserver>
class Swings {
 public:
  Swings(const Scene& scene, const Solver& solver, const AnyStepper<T, E>& stepper,
         std::span<const Field> fields, std::span<double> values, Next next, Done done,
         Observe observe = {})
      : scene_(scene),
        solver_(solver),
        stepper_(stepper),
        request_(fields, scene, solver.recorded),
        next_(next),
        done_(done),
        observe_(observe),
        starts_(scene, solver),
        turns_(scene, solver, stepper),
        releases_(scene, solver, stepper, fields, values) {}

  /// Integrates all designs. Returns the number of steps of all lanes, idle lanes included.
  std::uint64_t run() {
    do {
      for (std::size_t lane = 0; lane < lanes; ++lane) refill(lane);
      while (active_ != 0) step();
      locate_turns();  // of the last swings
    } while (!restarted_.empty());
    locate_releases();
    return steps_taken_ * lanes;
  }

 private:
  using Number = typename Lanes<T>::Number;
  using Instant = trebsweep::Instant<T, E>;
  static constexpr std::size_t lanes = Lanes<T>::count;

  void step() {
    Instant& from = now_[steps_taken_ % 2];
    Instant& to = now_[++steps_taken_ % 2];
    LaneMask ended = stepper_.adaptive ? adaptive_step(from, to) : fixed_step(from, to);
    for (; ended != 0; ended &= ended - 1) refill(first_lane(ended));
  }

  /// A step of a fixed-step method. Returns the lanes whose swing has ended.
  LaneMask fixed_step(Instant& from, Instant& to) {
    State<T, E> no_error_estimate;
    advance(stepper_, lanes_.motion, from, lanes_.h, to, no_error_estimate);
    const LaneMask turning = turns_.find(lanes_.motion, from, to);
    const LaneMask events =
        rule_.possible(from, to) | turning | turns_.stop_after(lanes_.motion, from, to);
    const LaneMask ended = check_events(events, ~LaneMask{0}, turning, from, to);
    if (observing_ && (ended & 1) == 0) [[unlikely]]
      observe_fixed_step(from, to);
    follow(lanes_, record_, best_, active_ & ~ended, from, to, lanes_.h);
    return ended;
  }

  /// A step of an adaptive method, which also chooses the next step length. Where the step is
  /// rejected, `to` becomes a copy of `from`. Returns the lanes whose swing has ended.
  LaneMask adaptive_step(Instant& from, Instant& to) {
    const T remaining = max_time_ - from.t;
    const auto last = remaining <= lanes_.h;
    const T h = select(last, remaining, lanes_.h);
    const auto [good, next] = try_step(stepper_, lanes_.motion, from, h, to, solver_.tolerance);
    to.t = select(last, max_time_, to.t);
    lanes_.h = next;
    const LaneMask turning = turns_.find(lanes_.motion, from, to);
    const LaneMask stopped = lanes_of((to.t >= max_time_) | (lanes_.h < shortest_step_));
    const LaneMask accepted = lanes_of(good);
    const LaneMask ended =
        check_events(rule_.possible(from, to) | turning | stopped, accepted, turning, from, to);
    if (observing_ && (accepted & ~ended & 1) != 0) [[unlikely]]
      observe_(from, to);
    if ((~accepted & active_) != 0) copy_where<T>(!good, to, from);
    // A rejected step adds nothing.
    follow(lanes_, record_, best_, active_ & ~ended, from, to, step_between(from, to));
    return ended;
  }

  [[gnu::noinline]] void observe_fixed_step(Instant from, Instant to) {
    set_times(1, from, to);
    observe_(from, to);
  }

  /// Extends records by a step of the swings in a pack, if they are needed, and searches for the
  /// best release in the lanes of `mask`.
  void follow(const LaneState<T, E>& state, SwingRecord<T>& record, BestRelease<T, E>& best,
              LaneMask mask, const Instant& from, const Instant& to, const T& h) {
    if (rule_.chooses() || request_.steps()) follow_needed(state, record, best, mask, from, to, h);
  }

  [[gnu::noinline]] void follow_needed(const LaneState<T, E>& state, SwingRecord<T>& record,
                                       BestRelease<T, E>& best, LaneMask mask, const Instant& from,
                                       const Instant& to, const T& h) {
    const Mechanism<T, E> mechanism(scene_, state.design);
    mask &= ~lanes_of(state.motion.sliding() > T(0));
    if (rule_.chooses())
      best.try_step(mask, solver_.release, state.motion, mechanism, from, to, h, record);
    if (request_.steps())
      record = record_step(record, request_, stepper_, solver_.tolerance, state.motion, mechanism,
                           from, to, h);
  }

  /// Handles possible events, and lanes that have used up their steps. Returns the lanes whose
  /// swing has ended or waits.
  LaneMask check_events(LaneMask events, LaneMask accepted, LaneMask turning, Instant& from,
                        Instant& to) {
    if (steps_taken_ >= next_step_check_) events |= lanes_at_step_limit();
    events &= active_;
    if (events == 0) [[likely]]
      return 0;
    return handle_events(events, accepted, turning, from, to);
  }

  /// The lanes that have used up their steps. Sets the step at which to check again.
  LaneMask lanes_at_step_limit() {
    LaneMask mask = 0;
    next_step_check_ = std::numeric_limits<std::uint64_t>::max();
    for (LaneMask left = active_; left != 0; left &= left - 1) {
      const std::size_t lane = first_lane(left);
      if (steps(lane) >= step_limit_) mask |= LaneMask{1} << lane;
      // After each restart, fixed steps reach max_time one step later.
      const std::uint64_t limit = owner_[lane].first_step + step_limit_;
      next_step_check_ = std::min(next_step_check_, std::max(limit, steps_taken_ + 1));
    }
    return mask;
  }

  /// The steps of the swing in a lane so far.
  std::uint64_t steps(std::size_t lane) const { return steps_taken_ - owner_[lane].first_step; }

  /// Returns the lanes in `events` whose swing has ended, and reports them, or waits.
  [[gnu::noinline]] LaneMask handle_events(LaneMask events, LaneMask accepted, LaneMask turning,
                                           Instant& from, Instant& to) {
    if (!stepper_.adaptive) set_times(events, from, to);
    turning |=
        lanes_of(rule_.may_turn_beyond(from, to)) & ~lanes_of(lanes_.motion.sliding() > T(0));
    LaneMask left = 0;
    for (; events != 0; events &= events - 1) {
      const std::size_t lane = first_lane(events);
      const SwingStep<T, E> step{
          lane, owner_[lane].index, steps(lane), lanes_, record_, best_, from, to};
      if (leaves_lane(step, accepted >> lane & 1, turning >> lane & 1)) left |= LaneMask{1} << lane;
    }
    if (turns_.stop_after(lanes_.motion, from, to) != 0)
      turns_.stop(turns_.stopping(lanes_.motion, from, to), lanes_.motion, to);
    return left;
  }

  /// Whether the swing of a step ends or waits until its events are located.
  bool leaves_lane(const SwingStep<T, E>& step, bool accepted, bool turns) {
    if (!is_finite(step.to, step.lane) && (!stepper_.adaptive || step_underflows(step)))
      return end(Status::non_finite, step, step.from);
    if (accepted) {
      const bool late = get_lane(step.to.t, step.lane) > latest_;
      if (turns && step.steps < solver_.max_steps && (step.sliding() || !late)) {
        turning_.push(step, {true, recording_, rule_.chooses()});
        if (turning_.full()) locate_turns();
        return true;
      }
      if (ends(step)) return true;
    } else if (step_underflows(step)) {
      return end(Status::step_underflow, step, step.from);
    }
    return step.steps >= solver_.max_steps &&
           end(Status::step_budget, step, accepted ? step.to : step.from);
  }

  /// Whether a swing ends with an accepted step, without turns before its end.
  bool ends(const SwingStep<T, E>& step) {
    const auto& [lane, index, steps, state, record, best, from, to] = step;
    const Number t = get_lane(to.t, lane);
    const bool late = t > latest_;
    if (!step.sliding() && rule_.ends(lane, from, to) && !(late && rule_.is_window())) {
      const bool needs_step = observing_ || recording_ || !rule_.is_window();
      ending_.push(step, {needs_step, recording_, rule_.chooses()});
      if (ending_.full()) locate_releases();
      return true;
    }
    const Status unreleased = step.sliding() ? Status::never_lifted : Status::not_released;
    if (late) return end(unreleased, step, from);
    return (t >= Number(solver_.max_time) || rule_.gives_up(lane, step.sliding(), from, to)) &&
           end(unreleased, step, to);
  }

  /// Reports the end of a swing without a release.
  bool end(Status status, const SwingStep<T, E>& step, const Instant& at) {
    done_(step.index, outcome_of(status, at, step.lane, Number(0), step.steps));
    return true;
  }

  /// Locates the turns of the swings that wait. Those that do not end with the located one restart
  /// from it.
  [[gnu::noinline]] void locate_turns() {
    if (turning_.lanes == 0) return;
    turning_.fill_idle_lanes();
    auto& [state, record, from, to, best, index, steps, waiting] = turning_;
    const T lifts_off = turns_.locate(state.motion, from, to);
    for (LaneMask left = waiting; left != 0; left &= left - 1) {
      const std::size_t lane = first_lane(left);
      if (ends(turning_.step(lane))) waiting &= ~(LaneMask{1} << lane);
    }
    if (waiting == 0) return;
    follow(state, record, best, waiting, from, to, step_between(from, to));
    if constexpr (E.trough) {
      record.lift_off_time = select(lifts_off > T(0), to.t, record.lift_off_time);
      record.projectile_clearance =
          select(lifts_off > T(0), T(scene_.trough_height), record.projectile_clearance);
    }
    if (observing_) observe_(from, to);
    turns_.lift_off(lifts_off, state.motion, to);
    restarted_.push_back(std::exchange(turning_, WaitingSwings<T, E>{}));
  }

  /// Locates the releases of the swings that wait for it.
  [[gnu::noinline]] void locate_releases() {
    if (ending_.lanes == 0) return;
    ending_.fill_idle_lanes();
    releases_.locate(ending_, [&](std::uint64_t index, const auto& outcome) {
      done_(index, outcome);
      if (observing_ && has_speed(outcome.status)) observe_(ending_.from, ending_.to);
    });
    ending_.lanes = 0;
  }

  /// Whether the next step of an adaptive method would be too short to change the time; near t = 0,
  /// time-step takes the place of the time.
  bool step_underflows(const SwingStep<T, E>& step) const {
    const Number time = std::max<Number>(get_lane(step.from.t, step.lane), solver_.time_step);
    return stepper_.adaptive &&
           get_lane(lanes_.h, step.lane) < std::numeric_limits<Number>::epsilon() * time;
  }

  /// Sets the times of a step of a fixed-step method.
  void set_times(LaneMask mask, Instant& from, Instant& to) {
    for (; mask != 0; mask &= mask - 1) {
      const std::size_t lane = first_lane(mask);
      set_lane(from.t, lane, time_after(lane, steps_taken_ - 1));
      set_lane(to.t, lane, time_after(lane, steps_taken_));
    }
  }

  Number time_after(std::size_t lane, std::uint64_t step) const {
    return owner_[lane].time_after(step, solver_.time_step);
  }

  /// Continues a swing after an event in a lane or starts the next design, or leaves the lane idle
  /// after the last one.
  void refill(std::size_t lane) {
    Instant& now = now_[steps_taken_ % 2];
    if (!restarted_.empty()) {
      restart(lane, now);
    } else {
      if (starts_.empty())
        starts_.refill(stepper_, next_, [&](std::uint64_t index, Status status) {
          done_(index, Outcome<Number, E>{status, Number(0), {}, Number(0), 0});
        });
      if (starts_.empty()) {
        active_ &= ~(LaneMask{1} << lane);
        return;
      }
      owner_[lane] = {starts_.pop(lane, lanes_, now), steps_taken_, steps_taken_, Number(0)};
      if (recording_) copy_lane<T>(record_, lane, SwingRecord<T>(), 0);
      if (rule_.chooses()) best_.reset(lane);
    }
    next_step_check_ = std::min(next_step_check_, owner_[lane].first_step + step_limit_);
    active_ |= LaneMask{1} << lane;
  }

  /// Continues a swing after an event in a lane.
  [[gnu::noinline]] void restart(std::size_t lane, Instant& now) {
    WaitingSwings<T, E>& swings = restarted_.back();
    const std::size_t from = first_lane(swings.lanes);
    copy_lane<T>(lanes_, lane, swings.state, from);
    copy_lane<T>(record_, lane, swings.record, from);
    copy_lane<T>(now, lane, swings.to, from);
    if (rule_.chooses()) best_.copy(lane, swings.best, from);
    owner_[lane] = {swings.index[from], steps_taken_ - swings.steps[from], steps_taken_,
                    get_lane(now.t, lane)};
    swings.lanes &= swings.lanes - 1;
    if (swings.lanes == 0) restarted_.pop_back();
  }

  const Scene scene_;
  const Solver solver_;
  const AnyStepper<T, E>& stepper_;
  const RecordRequest request_;
  const bool recording_ = request_.any();
  Next next_;
  Done done_;
  Observe observe_;
  const bool observing_ = static_cast<bool>(observe_);

  const T max_time_ = Number(solver_.max_time);
  const Number latest_ = latest_time<Number>(solver_);
  const T shortest_step_ = std::numeric_limits<Number>::epsilon() *
                           std::max<Number>(solver_.max_time, solver_.time_step);
  const ReleaseRule<Number> rule_{solver_};
  const std::uint64_t step_limit_ = step_limit(solver_, stepper_.adaptive);

  LaneState<T, E> lanes_{};
  SwingRecord<T> record_{};
  BestRelease<T, E> best_;
  std::array<Instant, 2> now_{};  // the ends of the last step; which is which alternates
  std::array<LaneOwner<Number>, lanes> owner_{};
  LaneMask active_ = 0;
  std::uint64_t steps_taken_ = 0;
  std::uint64_t next_step_check_ = std::numeric_limits<std::uint64_t>::max();

  StartQueue<T, E> starts_;
  const Turns<T, E> turns_;
  const Releases<T, E> releases_;
  WaitingSwings<T, E> turning_, ending_;        // with turns, and with ends, to be located
  std::vector<WaitingSwings<T, E>> restarted_;  // that wait for lanes
};

}  // namespace trebsweep
