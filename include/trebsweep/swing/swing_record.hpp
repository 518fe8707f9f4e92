#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/load_samples.hpp"
#include "trebsweep/swing/peak.hpp"

namespace trebsweep {

/// Whether fields are computed in a number type. References in wider types only need the speed, and
/// compile faster.
template <class T>
inline constexpr bool has_fields = std::is_same_v<typename Lanes<T>::Number, double>;

/// The time of the lift-off, extremes of the loads, and the energy lost, from the start of a swing
/// on. Only what the fields need is recorded.
template <class T>
struct SwingRecord {
  T least_tension = std::numeric_limits<double>::infinity();  ///< N, of the sling at the projectile
  T peak_tension = 0;                                         ///< N, of the sling at the arm's tip
  T peak_axle_load = 0;                                       ///< N
  T peak_stress = 0;                                          ///< Pa
  T peak_hanger_tension = 0;                                  ///< N
  T loss = 0;                                                 ///< J, by friction and damping
  T lift_off_time = 0;  ///< s, of a swing that begins in a trough
};

/// The quantities of a SwingRecord that some fields of a scene need.
struct RecordRequest {
  RecordRequest(std::span<const Field> fields, const Scene& scene) {
    for (const Field field : fields) {
      least_tension |= field == Field::slack || field == Field::least_sling_tension;
      peak_tension |= field == Field::peak_sling_tension;
      peak_axle_load |= field == Field::peak_axle_load;
      peak_stress |= field == Field::peak_beam_stress;
      peak_hanger_tension |= field == Field::peak_hanger_tension;
      lift_off |= field == Field::lift_off_time;
      loss |= field == Field::energy_drift && is_dissipative(scene);
    }
  }
  bool loads() const {
    return least_tension || peak_tension || peak_axle_load || peak_stress || peak_hanger_tension;
  }
  /// Whether the record grows with each step.
  bool steps() const { return loads() || loss; }
  bool any() const { return steps() || lift_off; }

  bool least_tension = false, peak_tension = false, peak_axle_load = false, peak_stress = false;
  bool peak_hanger_tension = false;
  bool loss = false, lift_off = false;
};

/// The mean power lost to friction and damping over a step, W: Gauss-Lobatto quadrature with five
/// nodes (Abramowitz and Stegun, table 25.6). The stepper itself integrates to the inner nodes.
template <class Stepper, class T, Effects E>
T mean_lost_power(Stepper& stepper, const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                  const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  constexpr double first = 0.17267316464601143;  // (1 - sqrt(3/7))/2
  constexpr std::array<double, 3> inner_nodes{first, 0.5, 1 - first};
  constexpr std::array<double, 3> weights{49.0 / 180, 16.0 / 45, 49.0 / 180};
  T power = T(1.0 / 20) * mechanism.dissipation(from.x);
  Instant<T, E> at;
  State<T, E> error;
  for (std::size_t i = 0; i < 3; ++i) {
    advance(stepper, motion, from, T(T(inner_nodes[i]) * h), at, error);
    power += T(weights[i]) * mechanism.dissipation(at.x);
  }
  power += T(1.0 / 20) * mechanism.dissipation(to.x);
  return power;
}

/// A record extended by the extremes of the polynomials through samples of the loads.
template <class T>
[[gnu::noinline]] SwingRecord<T> with_extremes(SwingRecord<T> record, const RecordRequest& request,
                                               const LoadSamples<T>& loads) {
  using std::abs;
  const auto peak_of = [&](auto load) {
    std::array<T, load_nodes.size()> values;
    std::transform(loads.begin(), loads.end(), values.begin(), load);
    return peak(load_nodes, values);
  };
  if (request.least_tension) {
    const T negative = peak_of([](const Loads<T>& l) { return T(-l.projectile_tension); });
    record.least_tension = -larger(T(-record.least_tension), negative);
  }
  if (request.peak_tension)
    record.peak_tension =
        larger(record.peak_tension, peak_of([](const Loads<T>& l) { return l.tip_tension; }));
  if (request.peak_axle_load)
    record.peak_axle_load =
        larger(record.peak_axle_load, peak_of([](const Loads<T>& l) { return l.axle; }));
  if (request.peak_hanger_tension)
    record.peak_hanger_tension = larger(
        record.peak_hanger_tension, peak_of([](const Loads<T>& l) { return l.hanger_tension; }));
  if (request.peak_stress) {
    // The larger of the peaks of bending to either side.
    T stress = loads[0].beam_stress;
    for (const Loads<T>& l : loads)
      stress = select(abs(stress) < abs(l.beam_stress), l.beam_stress, stress);
    const T side = select(stress < T(0), T(-1), T(1));
    record.peak_stress = larger(
        record.peak_stress, peak_of([&](const Loads<T>& l) { return T(side * l.beam_stress); }));
  }
  return record;
}

/// The number of parts of a step whose loads are interpolated separately. Methods of high order
/// take long steps, over which one interpolation would miss peaks by more than a relative 1e-5.
template <class Stepper>
int parts_of_step(const Stepper& stepper, double tolerance) {
  if constexpr (is_own_controller<Stepper>) return 4;  // extrapolation takes the longest steps
  if constexpr (is_adaptive<Stepper>)
    return is_interpolated(stepper) && stepper.order() > 5 && tolerance > 1e-8 ? 2 : 1;
  return 1;
}

/// A record extended by the loads over a step from `from` to `to`, of length h.
template <class Stepper, class T, Effects E>
SwingRecord<T> record_loads(SwingRecord<T> record, const RecordRequest& request, Stepper& stepper,
                            double tolerance, const Motion<T, E>& motion,
                            const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                            const Instant<T, E>& to, const T& h) {
  const int parts = parts_of_step(stepper, tolerance);
  const T part = T(1.0 / parts) * h;
  const auto sample = [&](const Instant<T, E>& begin, const Instant<T, E>& end) {
    if (is_interpolated(stepper)) return interpolated_loads(motion, mechanism, begin, end, part);
    return integrated_loads(stepper, motion, mechanism, begin, end, part);
  };
  Instant<T, E> last = from, next;
  State<T, E> error;
  for (int i = 1; i < parts; ++i) {
    advance(stepper, motion, from, T(T(i) * part), next, error);
    record = with_extremes(record, request, sample(last, next));
    last = next;
  }
  return with_extremes(record, request, sample(last, to));
}

/// A record extended by a step of length h, from `from` to `to`.
template <class Stepper, class T, Effects E>
SwingRecord<T> record_step(SwingRecord<T> record, const RecordRequest& request, Stepper& stepper,
                           double tolerance, const Motion<T, E>& motion,
                           const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                           const Instant<T, E>& to, const T& h) {
  if (request.loss) record.loss += h * mean_lost_power(stepper, motion, mechanism, from, to, h);
  if (request.loads())
    record = record_loads(record, request, stepper, tolerance, motion, mechanism, from, to, h);
  return record;
}

}  // namespace trebsweep
