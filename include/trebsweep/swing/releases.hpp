#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/swing/field_value.hpp"
#include "trebsweep/swing/release_rule.hpp"
#include "trebsweep/swing/waiting_swings.hpp"

namespace trebsweep {

/// Locates releases, and the ends of searches for the best one, within the last steps of swings.
template <class T, Effects E>
class Releases {
 public:
  /// See Swings for `fields` and `values`.
  Releases(const Scene& scene, const Solver& solver, const AnyStepper<T, E>& stepper,
           std::span<const Field> fields, std::span<double> values)
      : scene_(scene),
        solver_(solver),
        stepper_(stepper),
        fields_(fields),
        values_(values),
        request_(fields, scene, solver.recorded),
        rule_(solver) {}

  /// Makes the releases the ends of the last steps, writes the fields, and calls
  /// done(index, outcome) for each swing.
  template <class Done>
  void locate(WaitingSwings<T, E>& swings, Done done) const {
    auto& [state, record, from, to, best, index, steps, lanes] = swings;
    const Mechanism<T, E> mechanism(scene_, state.design);
    LaneMask released = ~LaneMask{0};
    if (rule_.chooses())
      released = choose(mechanism, swings);
    else if (!rule_.is_window())
      to = event_between(rule_.event(), stepper_, state.motion, from, to);
    const T speed = mechanism.speed(to.x);
    const LaneMask below_ground = write_fields(mechanism, swings);
    for (LaneMask left = lanes; left != 0; left &= left - 1) {
      const std::size_t lane = first_lane(left);
      const Status status = (released >> lane & 1) == 0       ? Status::not_released
                            : !is_finite(to, lane)            ? Status::non_finite
                            : get_lane(to.t, lane) > latest_  ? Status::not_released
                            : rule_.is_beyond(lane, to)       ? Status::not_released
                            : (below_ground >> lane & 1) != 0 ? Status::released_below_ground
                                                              : Status::released;
      done(index[lane], outcome_of(status, to, lane, get_lane(speed, lane), steps[lane]));
    }
  }

 private:
  using Number = typename Lanes<T>::Number;

  /// Makes the best release the end of the last step, which was the end of the search. Returns the
  /// lanes that have one.
  LaneMask choose(const Mechanism<T, E>& mechanism, WaitingSwings<T, E>& swings) const {
    auto& [state, record, from, to, best, index, steps, lanes] = swings;
    to = end_of_search(state.motion, from, to);
    best.try_step(lanes, solver_.release, state.motion, mechanism, from, to, step_between(from, to),
                  record);
    const BestMoment<T, E>& moment = best.moment();
    const LaneMask exists = lanes_of(moment.worth > T(-std::numeric_limits<double>::infinity()));
    to =
        best_instant(moment, solver_.release, solver_.tolerance, stepper_, state.motion, mechanism);
    from = moment.bracket.from;
    record = moment.record;
    return exists;
  }

  /// The end of the search within the last step: the first of phi1 = 3 pi/2 and max_time.
  Instant<T, E> end_of_search(const Motion<T, E>& motion, const Instant<T, E>& from,
                              const Instant<T, E>& to) const {
    const auto passes = rule_.reached(to);
    Instant<T, E> end = to;
    if (any(passes))
      copy_where<T>(passes, end, event_between(rule_.event(), stepper_, motion, from, to));
    const T max_time(Number(solver_.max_time));
    const auto late = end.t > max_time;
    if (any(late)) {
      Instant<T, E> limited;
      State<T, E> error;
      advance(stepper_, motion, from, select(late, T(max_time - from.t), T(to.t - from.t)), limited,
              error);
      copy_where<T>(late, end, limited);
    }
    return end;
  }

  /// Returns the lanes that are below the ground, if a field of the flight is requested.
  LaneMask write_fields(const Mechanism<T, E>& mechanism, WaitingSwings<T, E>& swings) const {
    if (fields_.empty()) return 0;
    auto& [state, record, from, to, best, index, steps, lanes] = swings;
    if (request_.steps())
      record = record_step(record, request_, stepper_, solver_.tolerance, state.motion, mechanism,
                           from, to, step_between(from, to));
    LaneMask below_ground = 0;
    Flight<T> flight{};
    if (flying_) {
      flight = trebsweep::flight(scene_, mechanism.projectile(to.x), mechanism.velocity(to.x));
      // Even where very strong drag prevents a range, there is an apex above the ground.
      below_ground = lanes_of(!(flight.apex >= T(0)));
    }
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const T value = value_at_release(fields_[f], mechanism, to.x, record, flight);
      for (LaneMask left = lanes; left != 0; left &= left - 1) {
        const std::size_t lane = first_lane(left);
        values_[index[lane] * fields_.size() + f] = static_cast<double>(get_lane(value, lane));
      }
    }
    return below_ground;
  }

  const Scene scene_;
  const Solver solver_;
  const AnyStepper<T, E>& stepper_;
  const std::span<const Field> fields_;
  const std::span<double> values_;
  const RecordRequest request_;
  const bool flying_ = std::any_of(fields_.begin(), fields_.end(), [](Field field) {
    return info(field).kind == FieldKind::flight;
  });
  const ReleaseRule<Number> rule_;
  const Number latest_ = latest_time<Number>(solver_);
};

}  // namespace trebsweep
