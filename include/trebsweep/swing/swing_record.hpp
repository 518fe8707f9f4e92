#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>

#include "trebsweep/ode/any_stepper.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/load_samples.hpp"
#include "trebsweep/swing/peak.hpp"

namespace trebsweep {

/// The time of the lift-off, extremes of the loads, and the energy lost, from the start of a swing
/// on. Only what the fields need is recorded.
template <class T>
struct SwingRecord {
  T least_tension = std::numeric_limits<double>::infinity();  ///< N, of the sling at the projectile
  T peak_tension = 0;                                         ///< N, of the sling at the arm's tip
  T peak_axle_load = 0;                                       ///< N
  T peak_stress = 0;                                          ///< Pa
  T peak_hanger_tension = 0;                                  ///< N
  T least_hanger_tension = std::numeric_limits<double>::infinity();  ///< N
  // Smallest heights above the ground, m; that of the projectile when it is not in the trough.
  T tip_clearance = std::numeric_limits<double>::infinity();
  T counterweight_clearance = std::numeric_limits<double>::infinity();
  T projectile_clearance = std::numeric_limits<double>::infinity();
  T loss = 0;           ///< J, by friction and damping
  T lift_off_time = 0;  ///< s, of a swing that begins in a trough
};

/// An extreme of a load along the swing, which is the value of a field, except for corrections of
/// rounding errors.
template <class T>
struct LoadExtreme {
  enum class Kind { smallest, largest, largest_magnitude };

  Field field;
  T SwingRecord<T>::*extreme;
  T Loads<T>::*load;
  Kind kind;

  /// Whether a field needs the extreme.
  bool serves(Field other) const {
    return other == field || (other == Field::slack && field == Field::least_sling_tension) ||
           (other == Field::ground_clearance &&
            (field == Field::tip_clearance || field == Field::counterweight_clearance ||
             field == Field::projectile_clearance));
  }
};

/// The extremes of a SwingRecord. The last three parameters are abbreviations.
template <class T, class R = SwingRecord<T>, class L = Loads<T>,
          class Kind = typename LoadExtreme<T>::Kind>
inline constexpr std::array<LoadExtreme<T>, 9> load_extremes{{
    {Field::least_sling_tension, &R::least_tension, &L::projectile_tension, Kind::smallest},
    {Field::least_hanger_tension, &R::least_hanger_tension, &L::hanger_tension, Kind::smallest},
    {Field::tip_clearance, &R::tip_clearance, &L::tip_height, Kind::smallest},
    {Field::counterweight_clearance, &R::counterweight_clearance, &L::counterweight_height,
     Kind::smallest},
    {Field::projectile_clearance, &R::projectile_clearance, &L::projectile_height, Kind::smallest},
    {Field::peak_sling_tension, &R::peak_tension, &L::tip_tension, Kind::largest},
    {Field::peak_axle_load, &R::peak_axle_load, &L::axle, Kind::largest},
    {Field::peak_hanger_tension, &R::peak_hanger_tension, &L::hanger_tension, Kind::largest},
    {Field::peak_beam_stress, &R::peak_stress, &L::beam_stress, Kind::largest_magnitude},
}};

/// The quantities of a SwingRecord that some fields of a scene need, and the steps that count for
/// its extremes.
struct RecordRequest {
  RecordRequest(std::span<const Field> fields, const Scene& scene, const TimeWindow& recorded)
      : window(recorded), counts_all(window.from <= 0 && std::isinf(window.until)) {
    for (const Field field : fields) {
      for (std::size_t i = 0; i < extremes.size(); ++i)
        if (load_extremes<double>[i].serves(field)) extremes.set(i);
      lift_off |= field == Field::lift_off_time;
      loss |= field == Field::energy_drift && is_dissipative(scene);
    }
  }
  /// Whether the record grows with each step.
  bool steps() const { return extremes.any() || loss; }
  bool any() const { return steps() || lift_off; }

  TimeWindow window;
  bool counts_all;
  std::bitset<load_extremes<double>.size()> extremes;
  bool loss = false, lift_off = false;
};

/// The mean power lost to friction and damping over a step, W: Gauss-Lobatto quadrature with five
/// nodes (Abramowitz and Stegun, table 25.6). The stepper itself integrates to the inner nodes.
template <class T, Effects E>
T mean_lost_power(const AnyStepper<T, E>& stepper, const Motion<T, E>& motion,
                  const Mechanism<T, E>& mechanism, const Instant<T, E>& from,
                  const Instant<T, E>& to, const T& h) {
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

/// The loads at a fraction of a step, to which the stepper itself integrates.
template <class T>
using LoadsWithin = std::function<Loads<T>(const T&)>;

/// The value with the largest magnitude.
template <class T, std::size_t N>
T largest_of(const std::array<T, N>& values) {
  using std::abs;
  T largest = values[0];
  for (const T& value : values) largest = select(abs(largest) < abs(value), value, largest);
  return largest;
}

/// A record extended by the extremes of the polynomials through samples of the loads. If `within`
/// is not empty, it gives the loads where the polynomials have their peaks: the error of an extreme
/// is then of the order of the square of the error of its place.
template <class T>
[[gnu::noinline]] SwingRecord<T> with_extremes(SwingRecord<T> record, const RecordRequest& request,
                                               const LoadSamples<T>& samples,
                                               const LoadsWithin<T>& within) {
  using Kind = typename LoadExtreme<T>::Kind;
  for (std::size_t i = 0; i < load_extremes<T>.size(); ++i) {
    if (!request.extremes[i]) continue;
    const LoadExtreme<T>& what = load_extremes<T>[i];
    std::array<T, load_nodes.size()> values;
    std::transform(samples.begin(), samples.end(), values.begin(),
                   [&](const Loads<T>& loads) { return loads.*what.load; });
    // The sign that makes the extreme a maximum; of a magnitude, that of the largest sample.
    T sign = what.kind == Kind::smallest ? -1 : 1;
    if (what.kind == Kind::largest_magnitude) sign = select(largest_of(values) < T(0), T(-1), T(1));
    for (T& value : values) value = sign * value;
    T& extreme = record.*what.extreme;
    const T before = what.kind == Kind::smallest ? T(-extreme) : extreme;
    auto [value, at] = peak(load_nodes, values);
    if (within) {
      const auto inside = (at > T(0)) & (at < T(1)) & (value > before);
      if (any(inside))
        value = select(inside, T(sign * within(select(inside, at, T(0.5))).*what.load), value);
    }
    const T after = larger(before, value);
    extreme = what.kind == Kind::smallest ? T(-after) : after;
  }
  return record;
}

/// The number of parts of a step whose loads are interpolated separately. Methods of high order
/// take long steps, over which one interpolation would miss peaks by more than a relative 1e-5.
template <class T, Effects E>
int parts_of_step(const AnyStepper<T, E>& stepper, double tolerance) {
  if (stepper.try_step) return 4;  // extrapolation takes the longest steps
  return stepper.interpolated && stepper.order > 5 && tolerance > 1e-8 ? 2 : 1;
}

/// Whether the stepper itself integrates to the peaks of loads: at tight tolerances, polynomials
/// would be less accurate than the motion.
template <class T, Effects E>
bool integrates_to_peaks(const AnyStepper<T, E>& stepper, double tolerance) {
  return stepper.adaptive && tolerance <= 1e-10;
}

/// A record extended by the loads over a step from `from` to `to`, of length h. The height of a
/// projectile in the trough does not count.
template <class T, Effects E>
SwingRecord<T> record_loads(const SwingRecord<T>& before, const RecordRequest& request,
                            const AnyStepper<T, E>& stepper, double tolerance,
                            const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                            const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  SwingRecord<T> record = before;
  const int parts = parts_of_step(stepper, tolerance);
  const T part = T(1.0 / parts) * h;
  Instant<T, E> last = from, next;
  State<T, E> error;
  const auto integrated = [&](const T& s) {
    Instant<T, E> at;
    advance(stepper, motion, last, T(s * part), at, error);
    return loads_at(motion, mechanism, at);
  };
  const bool exact = integrates_to_peaks(stepper, tolerance);
  LoadsWithin<T> within;
  if (exact) within = std::cref(integrated);
  const auto extend = [&](const Instant<T, E>& end) {
    const auto loads = stepper.interpolated
                           ? interpolated_loads(motion, mechanism, last, end, part)
                           : integrated_loads(stepper, motion, mechanism, last, end, part);
    record = with_extremes(record, request, loads, within);
    last = end;
  };
  for (int i = 1; i < parts; ++i) {
    advance(stepper, motion, from, T(T(i) * part), next, error);
    extend(next);
  }
  // Where an event ends the step, its state has been extrapolated, but not its rates.
  extend(exact ? instant(motion, to.t, to.x) : to);
  if constexpr (E.trough)
    record.projectile_clearance =
        select(motion.sliding() > T(0), before.projectile_clearance, record.projectile_clearance);
  return record;
}

/// A record extended by a step of length h, from `from` to `to`.
template <class T, Effects E>
SwingRecord<T> record_step(SwingRecord<T> record, const RecordRequest& request,
                           const AnyStepper<T, E>& stepper, double tolerance,
                           const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                           const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  if (request.loss) record.loss += h * mean_lost_power(stepper, motion, mechanism, from, to, h);
  if (!request.extremes.any()) return record;
  SwingRecord<T> after =
      record_loads(record, request, stepper, tolerance, motion, mechanism, from, to, h);
  if (request.counts_all) return after;
  const auto counts = (from.t >= T(request.window.from)) & (from.t < T(request.window.until));
  for (const LoadExtreme<T>& what : load_extremes<T>)
    after.*what.extreme = select(counts, after.*what.extreme, record.*what.extreme);
  return after;
}

}  // namespace trebsweep
