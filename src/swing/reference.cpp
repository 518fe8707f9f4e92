#include "trebsweep/swing/reference.hpp"

#include <cmath>

#include "trebsweep/swing/swing_by.hpp"

namespace trebsweep {
namespace {

using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits >= 64, "references need more digits than double");

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double loose_tolerance = 1e-14, tight_tolerance = 1e-16;

template <Effects E>
Outcome<Wide, E> swing_at(double tolerance, const Scene& scene, const Design<double>& design,
                          Solver solver, std::span<const Field> fields = {},
                          std::span<double> values = {}) {
  solver.release = located(solver.release);
  solver.tolerance = tolerance;
  return swing_by(any_stepper<Wide, E, Vern8<Wide, E>>(), scene, design, solver, {}, fields,
                  values);
}

/// A bound of the error of a result: its distance from the other one, plus rounding to double.
double bound(const Wide& result, const Wide& other) {
  return static_cast<double>(std::abs(result - other)) +
         std::numeric_limits<double>::epsilon() / 2 * std::abs(static_cast<double>(result));
}

/// The values of fields of a swing at a tolerance, rounded to double; NaN without a release.
std::vector<double> values_at(double tolerance, const Scene& scene, const Design<double>& design,
                              const Solver& solver, std::span<const Field> fields) {
  return with_general_effects(scene, [&]<Effects E>() {
    std::vector<double> values(fields.size(), nan);
    const auto outcome = swing_at<E>(tolerance, scene, design, solver, fields, values);
    if (!has_speed(outcome.status)) return std::vector<double>(fields.size(), nan);
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i] == Field::speed) values[i] = static_cast<double>(outcome.speed);
      if (fields[i] == Field::release_time) values[i] = static_cast<double>(outcome.t);
    }
    return values;
  });
}

}  // namespace

Reference reference(const Scene& scene, const Design<double>& design, const Solver& solver) {
  return with_general_effects(scene, [&]<Effects E>() {
    const auto loose = swing_at<E>(loose_tolerance, scene, design, solver);
    const auto tight = swing_at<E>(tight_tolerance, scene, design, solver);
    Reference r{tight.status, nan, nan, {}, nan, nan};
    for (std::size_t i = 0; i < coordinates<E>; ++i) r.state[i] = tight.x[i];
    if (!has_speed(tight.status)) return r;
    r.speed = static_cast<double>(tight.speed);
    r.release_time = tight.t;
    if (loose.status != tight.status) return r;
    r.speed_bound = bound(tight.speed, loose.speed);
    r.time_bound = bound(tight.t, loose.t);
    return r;
  });
}

std::vector<ReferenceValue> reference_values(const Scene& scene, const Design<double>& design,
                                             const Solver& solver, std::span<const Field> fields) {
  const auto loose = values_at(loose_tolerance, scene, design, solver, fields);
  const auto tight = values_at(tight_tolerance, scene, design, solver, fields);
  std::vector<ReferenceValue> values;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    // Both values are rounded, and the tighter one is reported.
    const double rounding = 1.5 * std::numeric_limits<double>::epsilon() * std::abs(tight[i]);
    values.push_back({tight[i], std::abs(tight[i] - loose[i]) + rounding});
  }
  return values;
}

double speed_in_extended_precision(const Scene& scene, const Design<double>& design,
                                   double tolerance, const Solver& solver) {
  return with_general_effects(scene, [&]<Effects E>() {
    Solver limits = solver;
    limits.max_steps = 100'000;
    const auto outcome = swing_at<E>(tolerance, scene, design, limits);
    return has_speed(outcome.status) ? static_cast<double>(outcome.speed) : nan;
  });
}

}  // namespace trebsweep
