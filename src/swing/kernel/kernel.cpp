#include "trebsweep/swing/kernel.hpp"

#include "trebsweep/swing/integrate_packs.hpp"
#include "trebsweep/swing/pack_steppers.hpp"

namespace trebsweep {
namespace {

template <Effects E>
using KernelStepper = AnyStepper<KernelPack, E>;

template <Effects E>
KernelStepper<E> kernel_stepper(std::string_view name) {
  return std::get<KernelStepper<E>>(pack_steppers(name));
}

/// A stepper of a single design, which is in the first lane.
template <Effects E>
KernelStepper<E> kernel_stepper(const SingleStepper& single) {
  using T = KernelPack;
  KernelStepper<E> stepper{single.adaptive, single.interpolated, single.order, single.error_order,
                           [&](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                               Instant<T, E>& to, State<T, E>& error) {
                             PlainState error_of_one{};
                             to = to_instant<T, E>(single.step(is_sliding(motion), to_plain(from),
                                                               get_lane(h, 0), error_of_one));
                             std::copy_n(error_of_one.begin(), error.size(), error.begin());
                           }};
  if (single.try_step)
    stepper.try_step = [&](const Motion<T, E>& motion, const Instant<T, E>& from, const T& h,
                           Instant<T, E>& to) {
      const PlainTrial trial = single.try_step(is_sliding(motion), to_plain(from), get_lane(h, 0));
      to = to_instant<T, E>(trial.to);
      return Trial<T>{T(trial.accepted ? 1 : 0) > T(0), T(trial.next)};
    };
  return stepper;
}

}  // namespace

[[gnu::visibility("default")]] std::string_view instruction_set() {
  if (!has_fused_multiply_add) return "baseline (2 lanes)";
  switch (register_lanes) {
    case 8:
      return "AVX-512 (8 lanes)";
    case 4:
      return "AVX2 with FMA (4 lanes)";
    default:
      return "generic with FMA (2 lanes)";
  }
}

[[gnu::visibility("default")]] Work integrate_packs(const Scene& scene, const Solver& solver,
                                                    const Batch& batch, ObservedSwing* observed,
                                                    const SingleStepper* single) {
  return with_effects(scene, [&]<Effects E>() {
    const auto stepper = single ? kernel_stepper<E>(*single) : kernel_stepper<E>(solver.stepper);
    return integrate_by(stepper, scene, solver, batch, SwingReporter(observed));
  });
}

[[gnu::visibility("default")]] PlainInstant advance_pack(const Scene& scene,
                                                         const Design<double>& design,
                                                         std::string_view stepper, bool sliding,
                                                         const PlainInstant& from, double h) {
  return with_effects(scene, [&]<Effects E>() {
    using T = KernelPack;
    Motion<T, E> motion(scene, {T(design.r1), T(design.r3), T(design.r2)});
    motion.set_sliding(T(sliding ? 1 : 0));
    const KernelStepper<E> method = kernel_stepper<E>(stepper);
    Instant<T, E> to;
    State<T, E> error;
    advance(method, motion, to_instant<T, E>(from), T(h), to, error);
    return to_plain(to);
  });
}

}  // namespace trebsweep
