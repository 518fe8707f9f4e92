#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/ode/step_size.hpp"
#include "trebsweep/swing/batch.hpp"
#include "trebsweep/swing/load_record.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// How a swing ended.
template <class Number, Effects E = Effects{}>
struct Outcome {
  Status status;
  Number t;             ///< s: the release, or the last moment reached
  State<Number, E> x;   ///< the state there
  Number speed;         ///< m/s; of a release only
  std::uint64_t steps;  ///< steps tried
};

/// An observer that looks at nothing.
struct NullObserver {
  template <class Instant>
  void operator()(const Instant&, const Instant&) const {}
};

/// The paper's rule: whether phi1 lies inside the window around pi.
template <class Number>
bool is_inside_window(const Number& angle, const Number& window) {
  using std::abs;
  return abs(Number(boost::math::constants::pi<Number>() - angle)) < window;
}

/// Integrates designs from rest to their release, or to the reason why there is none: as many at a
/// time as T has lanes, each with a time and a step of its own. A lane whose swing has ended takes
/// the next design.
///
/// `fields` are those that SwingResult does not have; values[n fields.size() + i] becomes field i
/// of design n, if that has a release.
///
/// next(design) sets the next design, or returns false if there is none. done(number, outcome)
/// takes the outcomes, in any order; designs are numbered as they came. observe(from, to) sees
/// every accepted step, the last one cut at the release; it needs a T of one lane.
template <class Stepper, class T, Effects E, class Next, class Done, class Observe = NullObserver>
class Swings {
 public:
  Swings(const Scene& scene, const Solver& solver, std::span<const Field> fields,
         std::span<double> values, Next next, Done done, Observe observe = {})
      : scene_(scene),
        solver_(solver),
        fields_(fields),
        values_(values),
        next_(next),
        done_(done),
        observe_(observe) {}

  /// Integrates all designs. Returns how many steps lanes have made, idle lanes included.
  std::uint64_t run() {
    for (std::size_t lane = 0; lane < lanes; ++lane) refill(lane);
    while (active_ != 0) step();
    land();
    return tried_ * lanes;
  }

  const Stepper& stepper() const { return stepper_; }

 private:
  using Number = typename Lanes<T>::Number;
  using Instant = trebsweep::Instant<T, E>;
  using Set = std::uint32_t;  // of lanes, a bit for each
  static constexpr std::size_t lanes = Lanes<T>::count;
  static constexpr bool adaptive = is_adaptive<Stepper>;
  static_assert(lanes == 1 || std::is_same_v<Observe, NullObserver>);

  /// A swing under way: one in every lane.
  struct Flight {
    Design<T> design;
    Motion<T, E> motion;
    T h;  // the next step's length; fixed steppers have the same for all
  };

  /// A swing whose last step has met the release.
  struct SwingResult {
    Design<T> design;
    Motion<T, E> motion;
    Instant from, to;
    LoadRecord<T> record;
  };

  /// Who is in a lane.
  struct Label {
    std::uint64_t number;
    std::uint64_t steps;  // of a flight: tried by all when it began; of a shot: tried by it
  };

  void step() {
    Instant& from = now_[tried_ % 2];
    Instant& to = now_[++tried_ % 2];
    Set ended;
    if constexpr (adaptive)
      ended = step_by_error(from, to);
    else
      ended = step_on(from, to);
    for (; ended != 0; ended &= ended - 1) refill(first_of(ended));
  }

  /// A step of a fixed stepper; returns the lanes that have ended their swing.
  Set step_on(Instant& from, Instant& to) {
    State<T, E> none;
    advance(stepper_, flight_.motion, from, flight_.h, to, none);
    // Not below the angle: NaN is seen too.
    Set special = lanes_of(!(to.x[phi1] < watched_angle_));
    if (solver_.release == Release::crossing)
      special |= lanes_of((from.x[w1] > T(0)) & (to.x[w1] < T(0)));
    if constexpr (E.pivot) special |= lanes_of(from.x[w1] * to.x[w1] < T(0));
    const Set ended = attend(special, ~Set{0}, from, to);
    if constexpr (lanes == 1) {
      if (ended == 0) observe_(at_step(from, 1), at_step(to, 0));
    }
    if (recording_) record(from, to, flight_.h);
    return ended;
  }

  /// A step of an adaptive stepper, and the next one's length; a lane whose error is too large
  /// stays where it was. Returns the lanes that have ended their swing.
  Set step_by_error(Instant& from, Instant& to) {
    const T left = max_time_ - from.t;
    const auto last = left <= flight_.h;
    const T h = select(last, left, flight_.h);
    const auto [good, next] = try_step(stepper_, flight_.motion, from, h, to, solver_.tolerance);
    to.t = select(last, max_time_, to.t);
    flight_.h = next;
    auto turned = (from.x[w1] > T(0)) & (to.x[w1] < T(0));
    if constexpr (E.pivot) turned = turned | ((from.x[w1] < T(0)) & (to.x[w1] > T(0)));
    const Set special = lanes_of((!(to.x[phi1] < watched_angle_)) | turned | (to.t >= max_time_) |
                                 (flight_.h < shortest_step_));
    const Set accepted = lanes_of(good);
    const Set ended = attend(special, accepted, from, to);
    if constexpr (lanes == 1) {
      if (good && ended == 0) observe_(from, to);
    }
    if ((~accepted & active_) != 0) {
      to.t = select(good, to.t, from.t);
      for (std::size_t i = 0; i < coordinates<E>; ++i) {
        to.x[i] = select(good, to.x[i], from.x[i]);
        to.dxdt[i] = select(good, to.dxdt[i], from.dxdt[i]);
      }
      for (std::size_t i = 0; i < 4; ++i) to.at[i] = select(good, to.at[i], from.at[i]);
    }
    // A step that was refused has become one of no length.
    if (recording_) record(from, to, T(to.t - from.t));
    return ended;
  }

  /// Continues all records over a step. Those of swings that have ended are begun anew, or wait
  /// with their shots already.
  [[gnu::noinline]] void record(const Instant& from, const Instant& to, const T& h) {
    record_ = extended(record_, flight_.design, flight_.motion, from, to, h);
  }

  /// A record continued over a step by what the fields need.
  LoadRecord<T> extended(LoadRecord<T> record, const Design<T>& design, const Motion<T, E>& motion,
                         const Instant& from, const Instant& to, const T& h) {
    const Mechanism<T, E> mechanism(scene_, design);
    if (losing_) record.loss += h * lost_power(stepper_, motion, mechanism, from, to, h);
    if (watched_.any())
      record = watch(record, watched_, stepper_, solver_.tolerance, motion, mechanism, from, to, h);
    return record;
  }

  static std::size_t first_of(Set set) { return static_cast<std::size_t>(std::countr_zero(set)); }

  /// The lanes of `special`, and those whose steps are used up, that have ended their swing.
  Set attend(Set special, Set accepted, Instant& from, Instant& to) {
    if (tried_ >= next_check_) special |= overdue();
    special &= active_;
    if (special == 0) [[likely]]
      return 0;
    return settle(special, accepted, from, to);
  }

  /// The lanes whose steps are used up.
  Set overdue() {
    Set set = 0;
    next_check_ = std::numeric_limits<std::uint64_t>::max();
    for (Set left = active_; left != 0; left &= left - 1) {
      const std::size_t lane = first_of(left);
      if (steps(lane) >= step_limit_)
        set |= Set{1} << lane;
      else
        next_check_ = std::min(next_check_, label_[lane].steps + step_limit_);
    }
    return set;
  }

  std::uint64_t steps(std::size_t lane) const { return tried_ - label_[lane].steps; }

  /// The lanes of `special` that have ended their swing; their outcomes are on their way.
  [[gnu::noinline]] Set settle(Set special, Set accepted, Instant& from, Instant& to) {
    if constexpr (!adaptive) set_times(special, from, to);
    Set ended = 0;
    [[maybe_unused]] const Set turning = special & accepted;
    if (solver_.release == Release::crossing) look_for_turns(special & accepted, from, to);
    for (; special != 0; special &= special - 1) {
      const std::size_t lane = first_of(special);
      if (ends(lane, (accepted >> lane & 1) != 0, from, to)) ended |= Set{1} << lane;
    }
    if constexpr (E.pivot) {
      if (scene_.pivot_friction > 0) stop(turning & ~ended, from, to);
    }
    return ended;
  }

  /// Whether the swing in a lane has ended with this step.
  bool ends(std::size_t lane, bool accepted, const Instant& from, const Instant& to) {
    const auto end = [&](Status status, const Instant& at) {
      deliver(label_[lane].number, status, at, lane, Number(0), steps(lane));
      return true;
    };
    if (!is_finite(to, lane) && (!adaptive || is_hopeless(lane, from)))
      return end(Status::non_finite, from);
    if (accepted) {
      const Number t = get_lane(to.t, lane);
      const bool late = t > latest_;
      if (is_released(lane, from, to) && !(late && solver_.release == Release::window)) {
        shoot(lane, from, to);
        return true;
      }
      if (late) return end(Status::not_released, from);
      if (t >= Number(solver_.max_time)) return end(Status::not_released, to);
    } else if (is_hopeless(lane, from)) {
      return end(Status::step_underflow, from);
    }
    if (steps(lane) >= solver_.max_steps) return end(Status::step_budget, accepted ? to : from);
    return false;
  }

  bool is_released(std::size_t lane, const Instant& from, const Instant& to) const {
    const Number angle = get_lane(to.x[phi1], lane);
    if (solver_.release == Release::window)
      return is_inside_window(angle, Number(solver_.release_window));
    const Number pi = boost::math::constants::pi<Number>();
    // Beyond it already, or at rest there from the start, is no crossing.
    return angle >= pi && get_lane(from.x[phi1], lane) < pi;
  }

  /// Whether the next step of an adaptive stepper would not move the clock on; near t = 0,
  /// time-step stands for the time.
  bool is_hopeless(std::size_t lane, const Instant& from) const {
    const Number clock = std::max<Number>(get_lane(from.t, lane), solver_.time_step);
    return adaptive && get_lane(flight_.h, lane) < std::numeric_limits<Number>::epsilon() * clock;
  }

  static bool is_finite(const Instant& at, std::size_t lane) {
    Number sum = 0;
    for (std::size_t i = 0; i < coordinates<E>; ++i)
      sum += Number(get_lane(at.x[i], lane) + get_lane(at.dxdt[i], lane));
    return is_finite_sum(sum);
  }

  /// The times of a fixed stepper: counted steps, so that they carry no sum of roundings.
  void set_times(Set set, Instant& from, Instant& to) {
    for (; set != 0; set &= set - 1) {
      const std::size_t lane = first_of(set);
      set_lane(from.t, lane, time_of(steps(lane) - 1));
      set_lane(to.t, lane, time_of(steps(lane)));
    }
  }

  Number time_of(std::uint64_t step) const { return Number(step) * Number(solver_.time_step); }

  /// A fixed stepper's instant, `back` steps before the last one.
  Instant at_step(Instant at, std::uint64_t back) const {
    at.t = time_of(steps(0) - back);
    return at;
  }

  /// Where the arm has turned back within the step, perhaps from beyond pi, the step's end becomes
  /// the turning point.
  void look_for_turns(Set set, const Instant& from, Instant& to) {
    const T pi = boost::math::constants::pi<Number>();
    // No further than this can it have come.
    const T reach = from.x[phi1] + T(to.t - from.t) * T(from.x[w1] - to.x[w1]);
    set &= lanes_of((from.x[phi1] < pi) & (to.x[phi1] < pi) & (reach >= pi) & (from.x[w1] > T(0)) &
                    (to.x[w1] < T(0)));
    if (set == 0) return;
    const Instant turn = turn_between(stepper_, flight_.motion, from, to);
    for (; set != 0; set &= set - 1) {
      const std::size_t lane = first_of(set);
      if (get_lane(turn.x[phi1], lane) >= boost::math::constants::pi<Number>())
        copy_lane<T>(to, lane, turn, lane);
    }
  }

  /// Lets dry friction decide where an arm comes to rest: the swing goes on from the turning point,
  /// or, with a fixed stepper, from the step's end without its rate.
  void stop(Set set, const Instant& from, Instant& to) {
    set &= lanes_of((from.x[w1] * to.x[w1]) < T(0));
    if (set == 0) return;
    Instant turn = to;
    if constexpr (adaptive) turn = turn_between(stepper_, flight_.motion, from, to);
    turn.x[w1] = T(0);
    flight_.motion.rates(turn.x, turn.at, turn.dxdt);
    for (; set != 0; set &= set - 1) copy_lane<T>(to, first_of(set), turn, first_of(set));
  }

  /// Puts a lane's swing among the shots that wait to land together.
  void shoot(std::size_t lane, const Instant& from, const Instant& to) {
    copy_lane<T>(shot_.design, shots_, flight_.design, lane);
    copy_lane<T>(shot_.to, shots_, to, lane);
    if (lanes == 1 || recording_ || solver_.release == Release::crossing) {
      copy_lane<T>(shot_.motion, shots_, flight_.motion, lane);
      copy_lane<T>(shot_.from, shots_, from, lane);
    }
    if (recording_) copy_lane<T>(shot_.record, shots_, record_, lane);
    shot_label_[shots_] = {label_[lane].number, steps(lane)};
    if (++shots_ == lanes) land();
  }

  /// Finds the releases of the shots that wait.
  [[gnu::noinline]] void land() {
    if (shots_ == 0) return;
    for (std::size_t lane = shots_; lane < lanes; ++lane) copy_lane<T>(shot_, lane, shot_, 0);
    if (solver_.release == Release::crossing)
      shot_.to = release_between(stepper_, shot_.motion, shot_.from, shot_.to);
    const Mechanism<T, E> mechanism(scene_, shot_.design);
    const T speed = mechanism.speed(shot_.to.x);
    record_fields(mechanism);
    const Set buried = ranging_ ? lanes_of(is_below_ground(mechanism, shot_.to.x)) : 0;
    for (std::size_t lane = 0; lane < shots_; ++lane) {
      const auto [number, tried] = shot_label_[lane];
      const Status status = !is_finite(shot_.to, lane)             ? Status::non_finite
                            : get_lane(shot_.to.t, lane) > latest_ ? Status::not_released
                            : (buried >> lane & 1) != 0            ? Status::released_below_ground
                                                                   : Status::released;
      deliver(number, status, shot_.to, lane, get_lane(speed, lane), tried);
      if constexpr (lanes == 1) {
        if (has_speed(status)) observe_(shot_.from, shot_.to);
      }
    }
    shots_ = 0;
  }

  /// The shots' values of the fields that are asked for.
  void record_fields(const Mechanism<T, E>& mechanism) {
    if (fields_.empty()) return;
    if (recording_)
      shot_.record = extended(shot_.record, shot_.design, shot_.motion, shot_.from, shot_.to,
                              T(shot_.to.t - shot_.from.t));
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const T value = value_at_release(fields_[f], mechanism, shot_.to.x, shot_.record);
      for (std::size_t lane = 0; lane < shots_; ++lane)
        values_[shot_label_[lane].number * fields_.size() + f] =
            static_cast<double>(get_lane(value, lane));
    }
  }

  void deliver(std::uint64_t number, Status status, const Instant& at, std::size_t lane,
               const Number& speed, std::uint64_t tried) {
    Outcome<Number, E> outcome{status, get_lane(at.t, lane), {}, speed, tried};
    for (std::size_t i = 0; i < coordinates<E>; ++i) outcome.x[i] = get_lane(at.x[i], lane);
    done_(number, outcome);
  }

  /// Gives a lane the next design; leaves it idle if there is none.
  void refill(std::size_t lane) {
    if (fresh_ == prepared_) prepare();
    if (fresh_ == prepared_) {
      active_ &= ~(Set{1} << lane);
      return;
    }
    copy_lane<T>(flight_, lane, start_, fresh_);
    copy_lane<T>(now_[tried_ % 2], lane, start_now_, fresh_);
    if (recording_) copy_lane<T>(record_, lane, LoadRecord<T>(), 0);
    label_[lane] = {start_number_[fresh_], tried_};
    next_check_ = std::min(next_check_, tried_ + step_limit_);
    active_ |= Set{1} << lane;
    ++fresh_;
  }

  /// Prepares the starts of the next designs, a lane for each.
  [[gnu::noinline]] void prepare() {
    fresh_ = prepared_ = 0;
    Design<T> design{1, 1, 1};
    Design<double> one;
    while (prepared_ < lanes && next_(one)) {
      const std::uint64_t number = designs_++;
      if (!start_is_reachable(scene_, one.r1)) {
        done_(number, Outcome<Number, E>{Status::unreachable_start, Number(0), {}, Number(0), 0});
        continue;
      }
      set_lane(design.r1, prepared_, Number(one.r1));
      set_lane(design.r3, prepared_, Number(one.r3));
      set_lane(design.r2, prepared_, Number(one.r2));
      start_number_[prepared_++] = number;
    }
    if (prepared_ == 0) return;
    start_.design = design;
    start_.motion = Motion<T, E>(scene_, design);
    start_now_ = instant(start_.motion, T(0), start<T, E>(scene_, design));
    start_.h = first_step(start_now_);
  }

  /// The step to begin with: a fixed stepper's own; of an adaptive one, so long that the rates at
  /// rest would change the state by a hundredth, were the error that part of the step which its
  /// order makes it (Hairer, Norsett and Wanner, II.4, without their second evaluation).
  T first_step(const Instant& at) const {
    using std::abs;
    if constexpr (!adaptive) return T(Number(solver_.time_step));
    const T a = abs(at.dxdt[w1]), b = abs(at.dxdt[w2]);
    const T rate = select(a < b, b, a);
    return rough_power(T(0.01 * solver_.tolerance), rate, 1.0 / (stepper_.order() + 1));
  }

  /// How many steps a swing may try before it is looked at.
  static std::uint64_t step_limit(const Solver& solver) {
    if (adaptive) return solver.max_steps;
    const double steps = std::ceil(solver.max_time / solver.time_step * (1 - 4e-16));
    return steps < static_cast<double>(solver.max_steps)
               ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(steps))
               : solver.max_steps;
  }

  const Scene scene_;
  const Solver solver_;
  const std::span<const Field> fields_;
  const std::span<double> values_;
  Next next_;
  Done done_;
  Observe observe_;
  Stepper stepper_ = make_stepper<Stepper>(solver_);

  const T max_time_ = Number(solver_.max_time);
  // Counted steps round.
  const Number latest_ =
      Number(solver_.max_time) * Number(1 + 4 * std::numeric_limits<double>::epsilon());
  const T shortest_step_ = std::numeric_limits<Number>::epsilon() *
                           std::max<Number>(solver_.max_time, solver_.time_step);
  const T watched_angle_ =
      boost::math::constants::pi<Number>() -
      Number(solver_.release == Release::window ? solver_.release_window * (1 + 1e-9) : 0);
  const std::uint64_t step_limit_ = step_limit(solver_);
  const Watched watched_{fields_};
  const bool losing_ = std::any_of(fields_.begin(), fields_.end(),
                                   [&](Field field) { return needs_loss(field, scene_); });
  const bool recording_ = watched_.any() || losing_;
  const bool ranging_ = std::count(fields_.begin(), fields_.end(), Field::range) > 0;

  Flight flight_{};
  LoadRecord<T> record_{};
  std::array<Instant, 2> now_{};  // the last step's ends in turn
  std::array<Label, lanes> label_{};
  Set active_ = 0;
  std::uint64_t tried_ = 0;
  std::uint64_t next_check_ = std::numeric_limits<std::uint64_t>::max();

  SwingResult shot_{};
  std::array<Label, lanes> shot_label_{};
  std::size_t shots_ = 0;

  Flight start_{};
  Instant start_now_{};
  std::array<std::uint64_t, lanes> start_number_{};
  std::size_t fresh_ = 0, prepared_ = 0;
  std::uint64_t designs_ = 0;
};

/// Integrates designs, and fills their shots and `fields`; see integrate().
template <class Stepper, class T, Effects E>
Work swing_all(const Scene& scene, const Solver& solver, const Batch& batch) {
  const auto& [designs, results, fields, values] = batch;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::fill(values.begin(), values.end(), nan);
  std::size_t at = 0;
  const auto next = [&](Design<double>& design) {
    if (at == designs.size()) return false;
    design = designs[at++];
    return true;
  };
  std::uint64_t steps = 0;
  const auto done = [&](std::uint64_t number, const auto& outcome) {
    const bool result = has_speed(outcome.status);
    steps += outcome.steps;
    results[number] = {result ? outcome.speed : nan, result ? outcome.t : nan, outcome.steps,
                       outcome.status};
    if (!result) std::ranges::fill(values.subspan(number * fields.size(), fields.size()), nan);
  };
  Swings<Stepper, T, E, decltype(next), decltype(done)> swings(scene, solver, fields, values, next,
                                                               done);
  const std::uint64_t lane_steps = swings.run();
  return {lane_steps, evaluations(swings.stepper(), steps)};
}

/// Integrates one design; see Swings.
template <class Stepper, class T, Effects E = Effects{}, class Observe = NullObserver>
Outcome<T, E> swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                    Observe&& observe = {}, std::span<const Field> fields = {},
                    std::span<double> values = {}) {
  Outcome<T, E> outcome{};
  bool given = false;
  const auto next = [&](Design<double>& d) {
    d = design;
    return !std::exchange(given, true);
  };
  const auto done = [&](std::uint64_t, const Outcome<T, E>& o) { outcome = o; };
  Swings<Stepper, T, E, decltype(next), decltype(done), Observe&>(scene, solver, fields, values,
                                                                  next, done, observe)
      .run();
  return outcome;
}

}  // namespace trebsweep
