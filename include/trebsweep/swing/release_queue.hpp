#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "trebsweep/ode/event.hpp"
#include "trebsweep/swing/field_value.hpp"
#include "trebsweep/swing/lane_state.hpp"

namespace trebsweep {

/// Swings whose last step contains the release. They wait until they fill a pack, so that root
/// finding and fields are computed for all lanes at once.
template <class Stepper, class T, Effects E>
class ReleaseQueue {
 public:
  /// See Swings for `fields` and `values`.
  ReleaseQueue(const Scene& scene, const Solver& solver, std::span<const Field> fields,
               std::span<double> values)
      : scene_(scene), solver_(solver), fields_(fields), values_(values), request_(fields, scene) {}

  bool full() const { return size_ == lanes; }

  /// Adds the swing in a lane, whose last step is from `from` to `to`.
  void push(std::size_t lane, std::uint64_t index, std::uint64_t steps,
            const LaneState<T, E>& state, const SwingRecord<T>& record, const Instant<T, E>& from,
            const Instant<T, E>& to) {
    copy_lane<T>(pending_.design, size_, state.design, lane);
    copy_lane<T>(pending_.to, size_, to, lane);
    if (lanes == 1 || recording_ || solver_.release == Release::crossing) {
      copy_lane<T>(pending_.motion, size_, state.motion, lane);
      copy_lane<T>(pending_.from, size_, from, lane);
    }
    if (recording_) copy_lane<T>(pending_.record, size_, record, lane);
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
    if (solver_.release == Release::crossing) to = release_between(stepper, motion, from, to);
    const Mechanism<T, E> mechanism(scene_, design);
    const T speed = mechanism.speed(to.x);
    write_fields(stepper, mechanism);
    const LaneMask below_ground = ranging_ ? lanes_of(is_below_ground(mechanism, to.x)) : 0;
    for (std::size_t lane = 0; lane < size_; ++lane) {
      const Status status = !is_finite(to, lane)              ? Status::non_finite
                            : get_lane(to.t, lane) > latest_  ? Status::not_released
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

  void write_fields(Stepper& stepper, const Mechanism<T, E>& mechanism) {
    if (fields_.empty()) return;
    auto& [design, motion, from, to, record] = pending_;
    if (recording_)
      record = record_step(record, request_, stepper, solver_.tolerance, motion, mechanism, from,
                           to, T(to.t - from.t));
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const T value = value_at_release(fields_[f], mechanism, to.x, record);
      for (std::size_t lane = 0; lane < size_; ++lane)
        values_[index_[lane] * fields_.size() + f] = static_cast<double>(get_lane(value, lane));
    }
  }

  const Scene scene_;
  const Solver solver_;
  const std::span<const Field> fields_;
  const std::span<double> values_;
  const RecordRequest request_;
  const bool recording_ = request_.any();
  const bool ranging_ = std::count(fields_.begin(), fields_.end(), Field::range) > 0;
  const Number latest_ = latest_time<Number>(solver_);

  PendingRelease pending_{};
  std::array<std::uint64_t, lanes> index_{}, steps_{};
  std::size_t size_ = 0;
};

}  // namespace trebsweep
