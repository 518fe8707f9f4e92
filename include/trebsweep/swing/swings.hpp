#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "trebsweep/swing/release_queue.hpp"
#include "trebsweep/swing/start_queue.hpp"

namespace trebsweep {

/// An observer that does nothing.
struct NullObserver {
  template <class Instant>
  void operator()(const Instant&, const Instant&) const {}
};

/// Integrates designs from rest to the event that ends their swing: one design per lane of T, each
/// with its own time and step length. When a swing ends, its lane starts the next design.
///
/// next(design) sets the next design, or returns false after the last one. done(index, outcome)
/// receives the outcomes in any order; designs are numbered in the order of next(). If design n has
/// a release, values[n * fields.size() + i] is set to fields[i], none of which may be in
/// SwingResult. observe(from, to) requires a T with one lane. It is called with the ends of every
/// accepted step, except the last one of a swing without a release; the last step of a released
/// swing ends at the release.
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
        releases_(scene, solver, fields, values) {}

  /// Integrates all designs. Returns the number of steps of all lanes, idle lanes included.
  std::uint64_t run() {
    for (std::size_t lane = 0; lane < lanes; ++lane) refill(lane);
    while (active_ != 0) step();
    locate_releases();
    return steps_taken_ * lanes;
  }

 private:
  using Number = typename Lanes<T>::Number;
  using Instant = trebsweep::Instant<T, E>;
  static constexpr std::size_t lanes = Lanes<T>::count;
  static constexpr bool adaptive = is_adaptive<Stepper>;
  static_assert(lanes == 1 || std::is_same_v<Observe, NullObserver>);

  /// The design in a lane.
  struct LaneOwner {
    std::uint64_t index;
    std::uint64_t first_step;  // steps_taken_ when its swing began
  };

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
    // Negated so that NaN is an event as well.
    LaneMask events = lanes_of(!(to.x[phi1] < event_angle_));
    if (solver_.release == Release::crossing)
      events |= lanes_of((from.x[w1] > T(0)) & (to.x[w1] < T(0)));
    if constexpr (E.pivot) events |= lanes_of(from.x[w1] * to.x[w1] < T(0));
    const LaneMask ended = check_events(events, ~LaneMask{0}, from, to);
    if constexpr (lanes == 1) {
      if (ended == 0) observe_(at_step(from, 1), at_step(to, 0));
    }
    if (recording_) record(from, to, lanes_.h);
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
    auto turned = (from.x[w1] > T(0)) & (to.x[w1] < T(0));
    if constexpr (E.pivot) turned = turned | ((from.x[w1] < T(0)) & (to.x[w1] > T(0)));
    const LaneMask events = lanes_of((!(to.x[phi1] < event_angle_)) | turned | (to.t >= max_time_) |
                                     (lanes_.h < shortest_step_));
    const LaneMask accepted = lanes_of(good);
    const LaneMask ended = check_events(events, accepted, from, to);
    if constexpr (lanes == 1) {
      if (good && ended == 0) observe_(from, to);
    }
    if ((~accepted & active_) != 0) {
      to.t = select(good, to.t, from.t);
#pragma GCC unroll 8
      for (std::size_t i = 0; i < coordinates<E>; ++i) {
        to.x[i] = select(good, to.x[i], from.x[i]);
        to.dxdt[i] = select(good, to.dxdt[i], from.dxdt[i]);
      }
#pragma GCC unroll 8
      for (std::size_t i = 0; i < direction_count<E>; ++i)
        to.directions[i] = select(good, to.directions[i], from.directions[i]);
    }
    if (recording_) {
      // A rejected step adds nothing to the record. Steppers need a length that is not zero.
      constexpr double negligible = 1e-30;
      record(from, to, select(good, T(to.t - from.t), T(negligible)));
    }
    return ended;
  }

  /// Extends the records of all lanes by a step; refill() resets those of swings that have ended.
  [[gnu::noinline]] void record(const Instant& from, const Instant& to, const T& h) {
    const Mechanism<T, E> mechanism(scene_, lanes_.design);
    record_ = record_step(record_, request_, stepper_, solver_.tolerance, lanes_.motion, mechanism,
                          from, to, h);
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
      if (steps(lane) >= step_limit_)
        mask |= LaneMask{1} << lane;
      else
        next_step_check_ = std::min(next_step_check_, owner_[lane].first_step + step_limit_);
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
    if (solver_.release == Release::crossing) locate_turning_points(events & accepted, from, to);
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
      if (is_released(lane, from, to) && !(late && solver_.release == Release::window)) {
        releases_.push(lane, owner_[lane].index, steps(lane), lanes_, record_, from, to);
        if (releases_.full()) locate_releases();
        return true;
      }
      if (late) return end(Status::not_released, from);
      if (t >= Number(solver_.max_time)) return end(Status::not_released, to);
    } else if (step_underflows(lane, from)) {
      return end(Status::step_underflow, from);
    }
    if (steps(lane) >= solver_.max_steps) return end(Status::step_budget, accepted ? to : from);
    return false;
  }

  /// The rule of release.
  bool is_released(std::size_t lane, const Instant& from, const Instant& to) const {
    using std::abs;
    const Number angle = get_lane(to.x[phi1], lane);
    const Number pi = boost::math::constants::pi<Number>();
    if (solver_.release == Release::window)
      return abs(Number(pi - angle)) < Number(solver_.release_window);
    // A start at phi1 >= pi is not a crossing.
    return angle >= pi && get_lane(from.x[phi1], lane) < pi;
  }

  void locate_releases() {
    releases_.locate_releases(
        stepper_, [&](std::uint64_t index, const auto& outcome,
                      [[maybe_unused]] const Instant& from, [[maybe_unused]] const Instant& to) {
          done_(index, outcome);
          if constexpr (lanes == 1) {
            if (has_speed(outcome.status)) observe_(from, to);
          }
        });
  }

  /// Whether the next step of an adaptive method would be too short to change the time; near t = 0,
  /// time-step takes the place of the time.
  bool step_underflows(std::size_t lane, const Instant& from) const {
    const Number time = std::max<Number>(get_lane(from.t, lane), solver_.time_step);
    return adaptive && get_lane(lanes_.h, lane) < std::numeric_limits<Number>::epsilon() * time;
  }

  /// Sets the times of a fixed-step method, n h, which accumulate no rounding errors.
  void set_times(LaneMask mask, Instant& from, Instant& to) {
    for (; mask != 0; mask &= mask - 1) {
      const std::size_t lane = first_lane(mask);
      set_lane(from.t, lane, time_of(steps(lane) - 1));
      set_lane(to.t, lane, time_of(steps(lane)));
    }
  }

  Number time_of(std::uint64_t step) const { return Number(step) * Number(solver_.time_step); }

  /// An instant of a fixed-step method, `back` steps before the last one, with its time.
  Instant at_step(Instant at, std::uint64_t back) const {
    at.t = time_of(steps(0) - back);
    return at;
  }

  /// Where the arm turns back within the step, having possibly passed phi1 = pi, the turning point
  /// becomes the end of the step.
  void locate_turning_points(LaneMask mask, const Instant& from, Instant& to) {
    const T pi = boost::math::constants::pi<Number>();
    // An upper bound of phi1 within the step.
    const T bound = from.x[phi1] + T(to.t - from.t) * T(from.x[w1] - to.x[w1]);
    mask &= lanes_of((from.x[phi1] < pi) & (to.x[phi1] < pi) & (bound >= pi) & (from.x[w1] > T(0)) &
                     (to.x[w1] < T(0)));
    if (mask == 0) return;
    const Instant turn = turn_between(stepper_, lanes_.motion, from, to);
    for (; mask != 0; mask &= mask - 1) {
      const std::size_t lane = first_lane(mask);
      if (get_lane(turn.x[phi1], lane) >= boost::math::constants::pi<Number>())
        copy_lane<T>(to, lane, turn, lane);
    }
  }

  /// Where the arm turns back, continues from rest, so that dry friction decides whether it moves:
  /// at the turning point, or at the end of the step of a fixed-step method.
  void apply_static_friction(LaneMask mask, const Instant& from, Instant& to) {
    mask &= lanes_of((from.x[w1] * to.x[w1]) < T(0));
    if (mask == 0) return;
    Instant turn = to;
    if constexpr (adaptive) turn = turn_between(stepper_, lanes_.motion, from, to);
    turn.x[w1] = T(0);
    lanes_.motion.rates(turn.x, turn.directions, turn.dxdt);
    for (; mask != 0; mask &= mask - 1) copy_lane<T>(to, first_lane(mask), turn, first_lane(mask));
  }

  /// Starts the next design in a lane, or leaves the lane idle after the last one.
  void refill(std::size_t lane) {
    if (starts_.empty())
      starts_.refill(stepper_, next_, [&](std::uint64_t index) {
        done_(index, Outcome<Number, E>{Status::unreachable_start, Number(0), {}, Number(0), 0});
      });
    if (starts_.empty()) {
      active_ &= ~(LaneMask{1} << lane);
      return;
    }
    owner_[lane] = {starts_.pop(lane, lanes_, now_[steps_taken_ % 2]), steps_taken_};
    if (recording_) copy_lane<T>(record_, lane, SwingRecord<T>(), 0);
    next_step_check_ = std::min(next_step_check_, steps_taken_ + step_limit_);
    active_ |= LaneMask{1} << lane;
  }

  /// The number of steps after which a swing may have to end.
  static std::uint64_t step_limit(const Solver& solver) {
    if (adaptive) return solver.max_steps;
    const double steps = std::ceil(solver.max_time / solver.time_step * (1 - 4e-16));
    return steps < static_cast<double>(solver.max_steps)
               ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(steps))
               : solver.max_steps;
  }

  const Scene scene_;
  const Solver solver_;
  Stepper& stepper_;
  const RecordRequest request_;
  const bool recording_ = request_.any();
  Next next_;
  Done done_;
  Observe observe_;

  const T max_time_ = Number(solver_.max_time);
  const Number latest_ = latest_time<Number>(solver_);
  const T shortest_step_ = std::numeric_limits<Number>::epsilon() *
                           std::max<Number>(solver_.max_time, solver_.time_step);
  const T event_angle_ =
      boost::math::constants::pi<Number>() -
      Number(solver_.release == Release::window ? solver_.release_window * (1 + 1e-9) : 0);
  const std::uint64_t step_limit_ = step_limit(solver_);

  LaneState<T, E> lanes_{};
  SwingRecord<T> record_{};
  std::array<Instant, 2> now_{};  // the ends of the last step; which is which alternates
  std::array<LaneOwner, lanes> owner_{};
  LaneMask active_ = 0;
  std::uint64_t steps_taken_ = 0;
  std::uint64_t next_step_check_ = std::numeric_limits<std::uint64_t>::max();

  StartQueue<Stepper, T, E> starts_;
  ReleaseQueue<Stepper, T, E> releases_;
};

}  // namespace trebsweep
