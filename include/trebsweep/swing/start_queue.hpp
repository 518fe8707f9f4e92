#pragma once

#include <array>
#include <cstdint>

#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/lane_state.hpp"

namespace trebsweep {

/// The initial states of the next designs, computed for a full pack at a time.
template <class T, Effects E>
class StartQueue {
 public:
  StartQueue(const Scene& scene, const Solver& solver) : scene_(scene), solver_(solver) {}

  bool empty() const { return first_ == size_; }

  /// Refills an empty queue from next(design), which returns false after the last design. Calls
  /// impossible(index, status) for designs that have no initial state.
  template <class Next, class Impossible>
  [[gnu::noinline]] void refill(const AnyStepper<T, E>& stepper, Next& next,
                                Impossible impossible) {
    first_ = size_ = 0;
    Design<T> designs{1, 1, 1};
    Design<double> design;
    while (size_ < lanes && next(design)) {
      const std::uint64_t index = designs_++;
      if (!start_is_reachable(scene_, design)) {
        impossible(index, Status::unreachable_start);
        continue;
      }
      if (!sling_reaches_trough(scene_, design)) {
        impossible(index, Status::sling_too_short);
        continue;
      }
      set_lane(designs.r1, size_, Number(design.r1));
      set_lane(designs.r3, size_, Number(design.r3));
      set_lane(designs.r2, size_, Number(design.r2));
      index_[size_++] = index;
    }
    if (size_ == 0) return;
    state_.design = designs;
    state_.motion = Motion<T, E>(scene_, designs);
    now_ = instant(state_.motion, T(0), start<T, E>(scene_, designs));
    if constexpr (E.trough) {
      // A trough that does not carry the projectile at the start is left at once.
      const T normal = state_.motion.normal_force(now_.x, now_.directions);
      state_.motion.set_sliding(select(normal > T(0), T(1), T(0)));
      state_.motion.rates(now_.x, now_.directions, now_.dxdt);
    }
    state_.h = first_step(stepper, now_);
  }

  /// Moves the first start to a lane and returns the index of its design.
  std::uint64_t pop(std::size_t lane, LaneState<T, E>& state, Instant<T, E>& now) {
    copy_lane<T>(state, lane, state_, first_);
    copy_lane<T>(now, lane, now_, first_);
    return index_[first_++];
  }

 private:
  using Number = typename Lanes<T>::Number;
  static constexpr std::size_t lanes = Lanes<T>::count;

  /// The length of the first step: the fixed step, or that for which a local error of h^(q + 1)
  /// times the initial acceleration is a tenth of the tolerance, q the order of the method
  /// (Hairer, Norsett and Wanner, II.4, without their second evaluation).
  T first_step(const AnyStepper<T, E>& stepper, const Instant<T, E>& at) const {
    using std::abs;
    if (!stepper.adaptive) return T(Number(solver_.time_step));
    const T a = abs(at.dxdt[w1]), b = abs(at.dxdt[w2]);
    T rate = select(a < b, b, a);
    if constexpr (E.hanger) {
      const T c = abs(at.dxdt[w3]);
      rate = select(rate < c, c, rate);
    }
    return rough_power(T(0.1 * solver_.tolerance), rate, 1.0 / (stepper.order + 1));
  }

  const Scene scene_;
  const Solver solver_;
  LaneState<T, E> state_{};
  Instant<T, E> now_{};
  std::array<std::uint64_t, lanes> index_{};
  std::size_t first_ = 0, size_ = 0;
  std::uint64_t designs_ = 0;
};

}  // namespace trebsweep
