#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "trebsweep/swing/release_queue.hpp"
#include "trebsweep/swing/release_rule.hpp"
#include "trebsweep/swing/restart_queue.hpp"
#include "trebsweep/swing/start_queue.hpp"

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
/// a release, values[n * fields.size() + i] is set to fields[i], none of which may be in
/// SwingResult. If `observe` is true, there is a single design, which is in the first lane, and
/// observe(from, to) is called with
/// the ends of every accepted step, except the last one of a swing without a release, and of the
/// step that ends at the release; by rules that choose the release, steps beyond it are observed
/// before.
template <class Stepper, class T, Effects E, class Next, class Done, class Observe = NullObserver>
class Swings {
 public:
  Swings(const Scene& scene, const Solver& solver, Stepper& stepper, std::span<const Field> fields,
         std::span<double> values, Next next, Done done, Observe observe = {})
      : scene_(scene),
        solver_(solver),
        stepper_(stepper),
        request_(fields, scene),
        next_(next),
        done_(done),
        observe_(observe),
        starts_(scene, solver),
        restarts_(scene, solver, request_),
        releases_(scene, solver, fields, values, observing_) {}

  /// Integrates all designs. Returns the number of steps of all lanes, idle lanes included.
  std::uint64_t run() {
    do {
      for (std::size_t lane = 0; lane < lanes; ++lane) refill(lane);
      while (active_ != 0) step();
      locate_restarts();  // of the last swings
    } while (!restarts_.empty());
    locate_releases();
    return steps_taken_ * lanes;
  }

 private:
  using Number = typename Lanes<T>::Number;
  using Instant = trebsweep::Instant<T, E>;
  static constexpr std::size_t lanes = Lanes<T>::count;
  static constexpr bool adaptive = is_adaptive<Stepper>;

  void step() {
    Instant& from = now_[steps_taken_ % 2];
    Instant& to = now_[++steps_taken_ % 2];
    LaneMask ended;
    if constexpr (adaptive)
      ended = adaptive_step(from, to);
    else
      ended = fixed_step(from, to);
    for (; ended != 0; ended &= ended - 1) refill(first_lane(ended));
  }

  /// A step of a fixed-step method. Returns the lanes whose swing has ended.
  LaneMask fixed_step(Instant& from, Instant& to) {
    State<T, E> no_error_estimate;
    advance(stepper_, lanes_.motion, from, lanes_.h, to, no_error_estimate);
    LaneMask events = rule_.possible(from, to);
    if constexpr (E.pivot) events |= lanes_of(from.x[w1] * to.x[w1] < T(0));
    if (restarting_) events |= restarts_.find(lanes_.motion, from, to);
    const LaneMask ended = check_events(events, ~LaneMask{0}, from, to);
    if (observing_ && (ended & 1) == 0) [[unlikely]]
      observe_fixed_step(from, to);
    follow(active_ & ~ended, from, to, lanes_.h);
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
    LaneMask events =
        rule_.possible(from, to) | lanes_of((to.t >= max_time_) | (lanes_.h < shortest_step_));
    if constexpr (E.pivot) events |= lanes_of(from.x[w1] * to.x[w1] < T(0));
    if (restarting_) events |= restarts_.find(lanes_.motion, from, to);
    const LaneMask accepted = lanes_of(good);
    const LaneMask ended = check_events(events, accepted, from, to);
    if (observing_ && (accepted & ~ended & 1) != 0) [[unlikely]]
      observe_(from, to);
    if ((~accepted & active_) != 0) copy_where<T>(!good, to, from);
    follow(active_ & ~ended, from, to, step_between(from, to));  // a rejected step adds nothing
    return ended;
  }

  [[gnu::noinline]] void observe_fixed_step(Instant from, Instant to) {
    set_times(1, from, to);
    observe_(from, to);
  }

  /// Extends records and searches by a step, if they are needed: those of the lanes in `mask`, or
  /// of all lanes.
  void follow(LaneMask mask, const Instant& from, const Instant& to, const T& h) {
    if (rule_.chooses()) search(mask & ~sliding_lanes(), from, to, h);
    if (request_.steps()) record(from, to, h);
  }

  [[gnu::noinline]] void record(const Instant& from, const Instant& to, const T& h) {
    const Mechanism<T, E> mechanism(scene_, lanes_.design);
    record_ = record_step(record_, request_, stepper_, solver_.tolerance, lanes_.motion, mechanism,
                          from, to, h);
  }

  [[gnu::noinline]] void search(LaneMask mask, const Instant& from, const Instant& to, const T& h) {
    const Mechanism<T, E> mechanism(scene_, lanes_.design);
    best_.try_step(mask, solver_.release, lanes_.motion, mechanism, from, to, h, record_);
  }

  /// Handles possible events, and lanes that have used up their steps. Returns the lanes whose
  /// swing has ended.
  LaneMask check_events(LaneMask events, LaneMask accepted, Instant& from, Instant& to) {
    if (steps_taken_ >= next_step_check_) events |= lanes_at_step_limit();
    events &= active_;
    if (events == 0) [[likely]]
      return 0;
    return handle_events(events, accepted, from, to);
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

  /// Returns the lanes in `events` whose swing has ended, and reports or queues their outcomes.
  [[gnu::noinline]] LaneMask handle_events(LaneMask events, LaneMask accepted, Instant& from,
                                           Instant& to) {
    if constexpr (!adaptive) set_times(events, from, to);
    LaneMask ended = 0;
    [[maybe_unused]] const LaneMask turning = events & accepted;
    rule_.end_at_turning_points(events & accepted & ~sliding_lanes(), stepper_, lanes_.motion, from,
                                to);
    for (; events != 0; events &= events - 1) {
      const std::size_t lane = first_lane(events);
      if (has_ended(lane, (accepted >> lane & 1) != 0, from, to)) ended |= LaneMask{1} << lane;
    }
    if constexpr (E.pivot) {
      if (scene_.pivot_friction > 0) apply_static_friction(turning & ~ended, from, to);
    }
    return ended;
  }

  /// Whether the swing in a lane has ended with this step.
  bool has_ended(std::size_t lane, bool accepted, const Instant& from, const Instant& to) {
    const auto end = [&](Status status, const Instant& at) {
      done_(owner_[lane].index, outcome_of(status, at, lane, Number(0), steps(lane)));
      return true;
    };
    if (!is_finite(to, lane) && (!adaptive || step_underflows(lane, from)))
      return end(Status::non_finite, from);
    if (accepted) {
      const Number t = get_lane(to.t, lane);
      const bool late = t > latest_;
      const bool sliding = (sliding_lanes() >> lane & 1) != 0;
      if (restarting_ && restarts_.finds(lane) && steps(lane) < solver_.max_steps &&
          (sliding || !late)) {
        if (late && !restarts_.lifts_off_before(max_time_, lane, stepper_, lanes_.motion, from))
          return end(Status::never_lifted, from);
        restarts_.push(lane, owner_[lane].index, steps(lane), lanes_, record_, best_, from, to);
        if (restarts_.full()) locate_restarts();
        return true;
      }
      if (!sliding && rule_.ends(lane, from, to) && !(late && rule_.is_window())) {
        releases_.push(lane, owner_[lane].index, steps(lane), lanes_, record_, best_, from, to);
        if (releases_.full()) locate_releases();
        return true;
      }
      const Status unreleased = sliding ? Status::never_lifted : Status::not_released;
      if (late) return end(unreleased, from);
      if (t >= Number(solver_.max_time) || rule_.gives_up(lane, sliding, from, to))
        return end(unreleased, to);
    } else if (step_underflows(lane, from)) {
      return end(Status::step_underflow, from);
    }
    if (steps(lane) >= solver_.max_steps) return end(Status::step_budget, accepted ? to : from);
    return false;
  }

  /// The lanes whose projectile slides in the trough.
  LaneMask sliding_lanes() const {
    if constexpr (E.trough) return lanes_of(lanes_.motion.sliding() > T(0));
    return 0;
  }

  void locate_restarts() {
    const auto ends = [&](std::size_t lane, std::uint64_t index, std::uint64_t steps,
                          const auto& pending, const BestRelease<T, E>& best) {
      const auto& [state, record, from, to, part, value] = pending;
      const bool sliding = get_lane(state.motion.sliding(), lane) > Number(0);
      if (!sliding && rule_.ends(lane, from, to)) {
        releases_.push(lane, index, steps, state, record, best, from, to);
        if (releases_.full()) locate_releases();
        return true;
      }
      if (!rule_.gives_up(lane, sliding, from, to)) return false;
      const Status unreleased = sliding ? Status::never_lifted : Status::not_released;
      done_(index, outcome_of(unreleased, to, lane, Number(0), steps));
      return true;
    };
    restarts_.locate(stepper_, ends, [&](const Instant& from, const Instant& to) {
      if (observing_) observe_(from, to);
    });
  }

  void locate_releases() {
    releases_.locate_releases(stepper_, [&](std::uint64_t index, const auto& outcome,
                                            const Instant& from, const Instant& to) {
      done_(index, outcome);
      if (observing_ && has_speed(outcome.status)) observe_(from, to);
    });
  }

  /// Whether the next step of an adaptive method would be too short to change the time; near t = 0,
  /// time-step takes the place of the time.
  bool step_underflows(std::size_t lane, const Instant& from) const {
    const Number time = std::max<Number>(get_lane(from.t, lane), solver_.time_step);
    return adaptive && get_lane(lanes_.h, lane) < std::numeric_limits<Number>::epsilon() * time;
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

  /// Where the arm turns back, continues from rest, so that dry friction decides whether it moves:
  /// at the turning point, or at the end of the step of a fixed-step method.
  void apply_static_friction(LaneMask mask, const Instant& from, Instant& to) {
    mask &= lanes_of((from.x[w1] * to.x[w1]) < T(0));
    // A projectile that slides through below the arm's tip turns the arm back without a stop.
    if constexpr (E.trough) mask &= ~(sliding_lanes() & lanes_of((from.x[w2] * to.x[w2]) > T(0)));
    if (mask == 0) return;
    Instant turn = to;
    const AngleEvent<Number> arm{false, Number(0)};
    if constexpr (adaptive) turn = turn_between(arm, stepper_, lanes_.motion, from, to);
    turn.x[w1] = T(0);
    // In the trough, an arm at rest holds the sling.
    if constexpr (E.trough) turn.x[w2] = select(lanes_.motion.sliding() > T(0), T(0), turn.x[w2]);
    lanes_.motion.rates(turn.x, turn.directions, turn.dxdt);
    for (; mask != 0; mask &= mask - 1) copy_lane<T>(to, first_lane(mask), turn, first_lane(mask));
  }

  /// Continues a swing after an event in a lane or starts the next design, or leaves the lane idle
  /// after the last one.
  void refill(std::size_t lane) {
    Instant& now = now_[steps_taken_ % 2];
    if (restarts_.has_located()) {
      const auto [index, steps] = restarts_.pop(lane, lanes_, record_, best_, now);
      owner_[lane] = {index, steps_taken_ - steps, steps_taken_, get_lane(now.t, lane)};
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

  const Scene scene_;
  const Solver solver_;
  Stepper& stepper_;
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
  const bool restarting_ = E.trough || rule_.is_of_sling();
  const std::uint64_t step_limit_ = step_limit<adaptive>(solver_);

  LaneState<T, E> lanes_{};
  SwingRecord<T> record_{};
  BestRelease<T, E> best_;
  std::array<Instant, 2> now_{};  // the ends of the last step; which is which alternates
  std::array<LaneOwner<Number>, lanes> owner_{};
  LaneMask active_ = 0;
  std::uint64_t steps_taken_ = 0;
  std::uint64_t next_step_check_ = std::numeric_limits<std::uint64_t>::max();

  StartQueue<Stepper, T, E> starts_;
  RestartQueue<Stepper, T, E> restarts_;
  ReleaseQueue<Stepper, T, E> releases_;
};

}  // namespace trebsweep
