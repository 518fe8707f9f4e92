#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/swing/best_release.hpp"
#include "trebsweep/swing/field_value.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/release_rule.hpp"

namespace trebsweep {

/// Swings whose last step contains the release, or the end of the search for the best one. They
/// wait until they fill a pack, so that root finding and fields are computed for all lanes at once.
template <class Stepper, class T, Effects E>
class ReleaseQueue {
 public:
  /// See Swings for `fields` and `values`. `observed` tells whether the starts of last steps
  /// matter.
  ReleaseQueue(const Scene& scene, const Solver& solver, std::span<const Field> fields,
               std::span<double> values, bool observed)
      : scene_(scene),
        solver_(solver),
        fields_(fields),
        values_(values),
        request_(fields, scene),
        observed_(observed) {}

  bool full() const { return size_ == lanes; }

  /// Adds the swing in a lane, whose last step is from `from` to `to`.
  void push(std::size_t lane, std::uint64_t index, std::uint64_t steps,
            const LaneState<T, E>& state, const SwingRecord<T>& record,
            const BestRelease<T, E>& best, const Instant<T, E>& from, const Instant<T, E>& to) {
    copy_lane<T>(pending_.design, size_, state.design, lane);
    copy_lane<T>(pending_.to, size_, to, lane);
    if (observed_ || recording_ || !rule_.is_window()) {
      copy_lane<T>(pending_.motion, size_, state.motion, lane);
      copy_lane<T>(pending_.from, size_, from, lane);
    }
    if (recording_) copy_lane<T>(pending_.record, size_, record, lane);
    if (rule_.chooses()) best_.copy(size_, best, lane);
    index_[size_] = index;
    steps_[size_] = steps;
    ++size_;
  }

  /// Locates the releases of all swings in the queue, writes their fields, and calls
  /// done(index, outcome, from, to), with the last step up to the release.
  template <class Done>
  [[gnu::noinline]] void locate_releases(Stepper& stepper, Done done) {
    if (size_ == 0) return;
    for (std::size_t lane = size_; lane < lanes; ++lane) copy_lane<T>(pending_, lane, pending_, 0);
    auto& [design, motion, from, to, record] = pending_;
    const Mechanism<T, E> mechanism(scene_, design);
    LaneMask released = ~LaneMask{0};
    if (rule_.chooses())
      released = choose(stepper, mechanism);
    else if (!rule_.is_window())
      to = event_between(rule_.event(), stepper, motion, from, to);
    const T speed = mechanism.speed(to.x);
    const LaneMask below_ground = write_fields(stepper, mechanism);
    for (std::size_t lane = 0; lane < size_; ++lane) {
      const Status status = (released >> lane & 1) == 0       ? Status::not_released
                            : !is_finite(to, lane)            ? Status::non_finite
                            : get_lane(to.t, lane) > latest_  ? Status::not_released
                            : rule_.is_beyond(lane, to)       ? Status::not_released
                            : (below_ground >> lane & 1) != 0 ? Status::released_below_ground
                                                              : Status::released;
      done(index_[lane], outcome_of(status, to, lane, get_lane(speed, lane), steps_[lane]), from,
           to);
    }
    size_ = 0;
  }

 private:
  using Number = typename Lanes<T>::Number;
  static constexpr std::size_t lanes = Lanes<T>::count;

  struct PendingRelease {
    Design<T> design;
    Motion<T, E> motion;
    Instant<T, E> from, to;
    SwingRecord<T> record;
  };

  /// Makes the best release the end of the last step, which was the end of the search. Returns the
  /// lanes that have one.
  LaneMask choose(Stepper& stepper, const Mechanism<T, E>& mechanism) {
    auto& [design, motion, from, to, record] = pending_;
    rule_.end_at_turning_points(~LaneMask{0}, stepper, motion, from, to);
    to = end_of_search(stepper, motion, from, to);
    best_.try_step((LaneMask{1} << size_) - 1, solver_.release, motion, mechanism, from, to,
                   step_between(from, to), record);
    const BestMoment<T, E>& moment = best_.moment();
    const LaneMask exists = lanes_of(moment.worth > T(-std::numeric_limits<double>::infinity()));
    to = best_instant(moment, solver_.release, solver_.tolerance, stepper, motion, mechanism);
    from = moment.bracket.from;
    record = moment.record;
    return exists;
  }

  /// The end of the search within the last step: the first of phi1 = 3 pi/2 and max_time.
  Instant<T, E> end_of_search(Stepper& stepper, const Motion<T, E>& motion,
                              const Instant<T, E>& from, const Instant<T, E>& to) const {
    const AngleEvent<Number>& event = rule_.event();
    Instant<T, E> end = to;
    const auto passes = event.value(to.x) >= T(event.target);
    if (any(passes)) copy_where<T>(passes, end, event_between(event, stepper, motion, from, to));
    const T max_time(Number(solver_.max_time));
    const auto late = end.t > max_time;
    if (any(late)) {
      Instant<T, E> limited;
      State<T, E> error;
      advance(stepper, motion, from, select(late, T(max_time - from.t), T(to.t - from.t)), limited,
              error);
      copy_where<T>(late, end, limited);
    }
    return end;
  }

  /// Returns the lanes that are below the ground, if a field of the flight is requested.
  LaneMask write_fields(Stepper& stepper, const Mechanism<T, E>& mechanism) {
    if (fields_.empty()) return 0;
    auto& [design, motion, from, to, record] = pending_;
    if (request_.steps())
      record = record_step(record, request_, stepper, solver_.tolerance, motion, mechanism, from,
                           to, step_between(from, to));
    LaneMask below_ground = 0;
    Flight<T> flight{};
    if (flying_) {
      flight = trebsweep::flight(scene_, mechanism.projectile(to.x), mechanism.velocity(to.x));
      // Even where very strong drag prevents a range, there is an apex above the ground.
      below_ground = lanes_of(!(flight.apex >= T(0)));
    }
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const T value = value_at_release(fields_[f], mechanism, to.x, record, flight);
      for (std::size_t lane = 0; lane < size_; ++lane)
        values_[index_[lane] * fields_.size() + f] = static_cast<double>(get_lane(value, lane));
    }
    return below_ground;
  }

  const Scene scene_;
  const Solver solver_;
  const std::span<const Field> fields_;
  const std::span<double> values_;
  const RecordRequest request_;
  const bool recording_ = request_.any();
  const bool observed_;
  const bool flying_ = std::any_of(fields_.begin(), fields_.end(), [](Field field) {
    return info(field).kind == FieldKind::flight;
  });
  const ReleaseRule<Number> rule_{solver_};
  const Number latest_ = latest_time<Number>(solver_);

  PendingRelease pending_{};
  BestRelease<T, E> best_;
  std::array<std::uint64_t, lanes> index_{}, steps_{};
  std::size_t size_ = 0;
};

}  // namespace trebsweep
