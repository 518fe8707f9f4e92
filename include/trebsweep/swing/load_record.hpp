#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>

#include "trebsweep/ode/interpolation.hpp"
#include "trebsweep/ode/stepper.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/peak.hpp"

namespace trebsweep {

/// What has been seen along a swing; of loads, those that are watched.
template <class T>
struct LoadRecord {
  T least_pull = std::numeric_limits<double>::infinity();  ///< N, of the sling on the projectile
  T peak_pull = 0;                                         ///< N, of the sling on the arm's tip
  T peak_axle = 0;                                         ///< N
  T peak_stress = 0;                                       ///< Pa
  T loss = 0;                                              ///< J, to friction
};

/// Which loads are watched.
struct Watched {
  explicit Watched(std::span<const Field> fields) {
    for (const Field field : fields) {
      least_pull |= field == Field::slack || field == Field::least_sling_tension;
      peak_pull |= field == Field::peak_sling_tension;
      peak_axle |= field == Field::peak_axle_load;
      peak_stress |= field == Field::peak_beam_stress;
    }
  }
  bool any() const { return least_pull || peak_pull || peak_axle || peak_stress; }

  bool least_pull = false, peak_pull = false, peak_axle = false, peak_stress = false;
};

/// The mean power lost to friction over a step, W: by Lobatto's quadrature with five points, to
/// which the stepper goes from the step's start.
template <class Stepper, class T, Effects E>
T lost_power(Stepper& stepper, const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
             const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  constexpr double early = 0.17267316464601143;  // (1 - sqrt(3/7))/2
  constexpr std::array<double, 3> inside{early, 0.5, 1 - early};
  constexpr std::array<double, 3> weights{49.0 / 180, 16.0 / 45, 49.0 / 180};
  T power = T(1.0 / 20) * mechanism.dissipation(from.x);
  Instant<T, E> at;
  State<T, E> error;
  for (std::size_t i = 0; i < 3; ++i) {
    advance(stepper, motion, from, T(T(inside[i]) * h), at, error);
    power += T(weights[i]) * mechanism.dissipation(at.x);
  }
  power += T(1.0 / 20) * mechanism.dissipation(to.x);
  return power;
}

/// Whether the motion within a step is interpolated to watch it, which costs a fraction of a step.
/// Otherwise the stepper goes there: the motion of an implicit one may be stiff, so that forces
/// magnify an error of the state, and steps of a fixed length need not be accurate.
template <class Stepper>
inline constexpr bool is_interpolated =
    is_adaptive<Stepper> &&
    !std::is_same_v<typename Stepper::stepper_category, odeint::error_stepper_tag>;

/// A record continued over a part of a step: by the peaks of the polynomials through the loads at
/// the places of Lobatto's quadrature with six points.
template <class Stepper, class T, Effects E>
LoadRecord<T> watch_part(LoadRecord<T> record, const Watched& watched, Stepper& stepper,
                         const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                         const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  using std::abs;
  constexpr double a = 0.11747233803526763, b = 0.3573842417596774;
  constexpr std::array<double, 6> places{0, a, b, 1 - b, 1 - a, 1};
  std::array<Loads<T>, 6> loads;
  loads.front() = mechanism.loads(from.x, from.dxdt);
  loads.back() = mechanism.loads(to.x, to.dxdt);
  [[maybe_unused]] const Quintic<T, E> between(from, to, h);
  for (std::size_t i = 1; i < 5; ++i) {
    Instant<T, E> at;
    if constexpr (is_interpolated<Stepper>) {
      at = instant(motion, T(0), between(places[i]));
    } else {
      State<T, E> error;
      advance(stepper, motion, from, T(T(places[i]) * h), at, error);
    }
    loads[i] = mechanism.loads(at.x, at.dxdt);
  }
  const auto peak_of = [&](auto load) {
    std::array<T, 6> values;
    std::transform(loads.begin(), loads.end(), values.begin(), load);
    return peak(places, values);
  };
  if (watched.least_pull) {
    const T pull = peak_of([](const Loads<T>& l) { return T(-l.projectile_pull); });
    record.least_pull = -larger(T(-record.least_pull), pull);
  }
  if (watched.peak_pull)
    record.peak_pull =
        larger(record.peak_pull, peak_of([](const Loads<T>& l) { return l.tip_pull; }));
  if (watched.peak_axle)
    record.peak_axle = larger(record.peak_axle, peak_of([](const Loads<T>& l) { return l.axle; }));
  if (watched.peak_stress) {
    // Of the bending to both sides, the larger one counts.
    T stress = loads[0].beam_stress;
    for (const Loads<T>& l : loads)
      stress = select(abs(stress) < abs(l.beam_stress), l.beam_stress, stress);
    const T side = select(stress < T(0), T(-1), T(1));
    record.peak_stress = larger(
        record.peak_stress, peak_of([&](const Loads<T>& l) { return T(side * l.beam_stress); }));
  }
  return record;
}

/// The same for packs, with all calls inlined.
template <class Stepper, std::size_t R, Effects E>
[[gnu::flatten]] inline LoadRecord<Pack<R>> watch_part(
    const LoadRecord<Pack<R>>& record, const Watched& watched, Stepper& stepper,
    const Motion<Pack<R>, E>& motion, const Mechanism<Pack<R>, E>& mechanism,
    const Instant<Pack<R>, E>& from, const Instant<Pack<R>, E>& to, const Pack<R>& h) {
  return watch_part<Stepper, Pack<R>, E>(record, watched, stepper, motion, mechanism, from, to, h);
}

/// In how many parts a step is watched. Steppers of high order take long steps, over which the
/// interpolation would miss peaks by more than 1e-5 of their size.
template <class Stepper>
int watched_parts([[maybe_unused]] const Stepper& stepper, [[maybe_unused]] double tolerance) {
  if constexpr (is_own_controller<Stepper>)
    return 4;  // extrapolation takes the longest
  else if constexpr (is_interpolated<Stepper>)
    return stepper.order() > 5 && tolerance > 1e-8 ? 2 : 1;
  else
    return 1;
}

/// A record's loads continued over a step of a stepper that follows `tolerance`, if any.
template <class Stepper, class T, Effects E>
LoadRecord<T> watch(LoadRecord<T> record, const Watched& watched, Stepper& stepper,
                    double tolerance, const Motion<T, E>& motion, const Mechanism<T, E>& mechanism,
                    const Instant<T, E>& from, const Instant<T, E>& to, const T& h) {
  const int parts = watched_parts(stepper, tolerance);
  const T part = T(1.0 / parts) * h;
  Instant<T, E> last = from, next;
  State<T, E> error;
  for (int i = 1; i < parts; ++i) {
    advance(stepper, motion, from, T(T(i) * part), next, error);
    record = watch_part(record, watched, stepper, motion, mechanism, last, next, part);
    last = next;
  }
  return watch_part(record, watched, stepper, motion, mechanism, last, to, part);
}

/// Whether a field of a scene needs a Record's loss.
inline bool needs_loss(Field field, const Scene& scene) {
  return field == Field::energy_drift && is_dissipative(scene);
}

/// Whether the projectile is below the ground, where it has no range.
template <class T, Effects E>
auto is_below_ground(const Mechanism<T, E>& mechanism, const State<T, E>& x) {
  return T(mechanism.scene().fulcrum_height) + mechanism.projectile(x).y < T(0);
}

/// A field's value at a release; not of those that SwingResult has: speed, release-time, status,
/// steps.
template <class T, Effects E>
T value_at_release(Field field, const Mechanism<T, E>& mechanism, const State<T, E>& x,
                   const LoadRecord<T>& record) {
  using std::sqrt;
  const Scene& scene = mechanism.scene();
  const auto kinetic = [&] {
    const T speed = mechanism.speed(x);
    return T(T(scene.projectile_mass / 2) * speed * speed);
  };
  const auto at_start = [&] { return start<T, E>(scene, mechanism.design()); };
  const auto given_up = [&] {
    return T(mechanism.potential_energy(at_start()) - mechanism.potential_energy(x));
  };
  switch (field) {
    case Field::sling_angle:
      return x[phi2];
    case Field::arm_rate:
      return x[w1];
    case Field::sling_rate:
      return x[w2];
    case Field::kinetic_energy:
      return kinetic();
    case Field::efficiency:
      return kinetic() / given_up();
    case Field::range: {
      const auto velocity = mechanism.velocity(x);
      const T g(scene.gravity), height = T(scene.fulcrum_height) + mechanism.projectile(x).y;
      const T fall = velocity.y * velocity.y + T(2) * g * height;
      const T none = std::numeric_limits<double>::quiet_NaN();
      const T flight = T(velocity.y + sqrt(select(fall > T(0), fall, T(0)))) / g;
      return select(height < T(0), none, T(velocity.x * flight));
    }
    case Field::energy_drift:
      return T(T(mechanism.energy(x) + record.loss) - mechanism.energy(at_start())) / given_up();
    case Field::slack:  // an elastic sling does not push: its pull ends at zero
      return select(E.elastic ? record.least_pull <= T(0) : record.least_pull < T(0), T(2), T(1));
    case Field::least_sling_tension:
      // Nor below: the parabola through its samples may.
      return E.elastic ? select(record.least_pull > T(0), record.least_pull, T(0))
                       : record.least_pull;
    case Field::peak_sling_tension:
      return record.peak_pull;
    case Field::peak_axle_load:
      return record.peak_axle;
    case Field::peak_beam_stress:
      return record.peak_stress;
    default:
      return T(std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace trebsweep
