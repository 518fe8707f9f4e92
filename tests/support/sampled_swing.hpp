#pragma once

#include <vector>

#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"

namespace trebsweep {

/// A swing integrated by short steps of vern8, without the step-size control, event location and
/// release rules of Swings.
template <Effects E>
class SampledSwing {
 public:
  using Instant = trebsweep::Instant<double, E>;

  /// `h` (s) is the length of the steps.
  SampledSwing(const Scene& scene, const Design<double>& design, double h)
      : h_(h), motion_(scene, design), advance_(make_advance<E>(scene, design, Solver{})) {
    now_ = instant(motion_, 0, start<double, E>(scene, design));
    if (normal_force(now_) <= 0) lift_off();
  }

  const Instant& now() const { return now_; }
  bool is_sliding() const { return motion_.sliding() > 0; }
  double normal_force(const Instant& at) const { return motion_.normal_force(at.x, at.directions); }

  /// Proceeds by a step, or to the zero of f(instant) where f falls below zero within it. Returns
  /// whether it does.
  template <class F>
  bool step_until(F f) {
    const Instant from = now_;
    now_ = advance_(motion_, from, h_);
    if (f(now_) >= 0 || f(from) < 0) return false;
    double low = 0, high = h_;
    while (low < (low + high) / 2 && (low + high) / 2 < high) {
      const double middle = (low + high) / 2;
      (f(advance_(motion_, from, middle)) < 0 ? high : low) = middle;
    }
    now_ = advance_(motion_, from, high);
    return true;
  }

  /// Proceeds to the lift-off, before which f(instant) must not fall below zero. Returns whether it
  /// is reached; calls observe(now()) after each step.
  template <class F, class Observe>
  bool slide(F f, Observe observe) {
    while (is_sliding()) {
      const Instant from = now_;
      if (step_until([&](const Instant& at) { return normal_force(at); })) {
        if (f(now_) < 0) return false;
        lift_off();
      } else if (f(now_) < 0) {
        now_ = from;
        step_until(f);
        return false;
      }
      observe(now_);
    }
    return true;
  }

 private:
  void lift_off() {
    motion_.set_sliding(0);
    motion_.rates(now_.x, now_.directions, now_.dxdt);
  }

  double h_;
  Motion<double, E> motion_;
  Advance<E> advance_;
  Instant now_;
};

}  // namespace trebsweep
