#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "trebsweep/swing/best_release.hpp"
#include "trebsweep/swing/lane_state.hpp"
#include "trebsweep/swing/swing_record.hpp"

namespace trebsweep {

/// The last step of the swing in a lane of a pack.
template <class T, Effects E>
struct SwingStep {
  std::size_t lane;
  std::uint64_t index;  ///< of the design
  std::uint64_t steps;  ///< of the swing, including this one
  const LaneState<T, E>& state;
  const SwingRecord<T>& record;   ///< up to `from`
  const BestRelease<T, E>& best;  ///< up to `from`
  const Instant<T, E>&from, &to;

  bool sliding() const {
    return get_lane(state.motion.sliding(), lane) > typename Lanes<T>::Number(0);
  }
};

/// What a rule of release and the fields need of a swing besides its design and its last instant.
struct Needed {
  bool step;    ///< the motion and the start of the last step
  bool record;  ///< the record
  bool best;    ///< the best release so far
};

/// Swings whose last step contains an event. They wait until they fill a pack, so that the events
/// of all lanes are located at once.
template <class T, Effects E>
struct WaitingSwings {
  LaneState<T, E> state{};
  SwingRecord<T> record;
  Instant<T, E> from{}, to{};
  BestRelease<T, E> best;
  std::array<std::uint64_t, Lanes<T>::count> index{}, steps{};
  LaneMask lanes = 0;  ///< those that hold swings

  bool full() const { return std::popcount(lanes) == static_cast<int>(Lanes<T>::count); }

  /// Copies what is needed of a swing to the next lane.
  void push(const SwingStep<T, E>& step, const Needed& needed) {
    const auto lane = static_cast<std::size_t>(std::countr_one(lanes));
    copy_lane<T>(state.design, lane, step.state.design, step.lane);
    copy_lane<T>(to, lane, step.to, step.lane);
    if (needed.step) {
      copy_lane<T>(state.motion, lane, step.state.motion, step.lane);
      copy_lane<T>(state.h, lane, step.state.h, step.lane);
      copy_lane<T>(from, lane, step.from, step.lane);
    }
    if (needed.record) copy_lane<T>(record, lane, step.record, step.lane);
    if (needed.best) best.copy(lane, step.best, step.lane);
    index[lane] = step.index;
    steps[lane] = step.steps;
    lanes |= LaneMask{1} << lane;
  }

  SwingStep<T, E> step(std::size_t lane) const {
    return {lane, index[lane], steps[lane], state, record, best, from, to};
  }

  /// Copies the first swing to the lanes that hold none, so that all hold numbers.
  void fill_idle_lanes() {
    for (std::size_t lane = 1; lane < Lanes<T>::count; ++lane) {
      if ((lanes >> lane & 1) != 0) continue;
      copy_lane<T>(state, lane, state, 0);
      copy_lane<T>(record, lane, record, 0);
      copy_lane<T>(from, lane, from, 0);
      copy_lane<T>(to, lane, to, 0);
    }
  }
};

}  // namespace trebsweep
