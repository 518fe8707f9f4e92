#pragma once

#include <array>
#include <span>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/field.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// A swing computed in extended precision: long double, whose significand has 64 bits on x86-64 and
/// 113 on ARM. Quadruple precision gives the same doubles, but takes fifty times as long.
struct Reference {
  Status status;
  double speed;                      ///< m/s, NaN without a release
  long double release_time;          ///< s, NaN without a release
  std::array<long double, 6> state;  ///< at the end; the first four of a rigid sling
  double speed_bound;                ///< m/s: bound of the error of `speed`
  double time_bound;                 ///< s: bound of the error of `release_time`
};

/// Integrates in extended precision by vern8 with two tolerances. The result is that of the
/// tighter one; the difference bounds its error. The bounds are NaN where the statuses differ. Only
/// max_time, max_steps and the located() release of `solver` are used.
Reference reference(const Scene& scene, const Design<double>& design, const Solver& solver);

/// The value of a field in extended precision, and a bound of its error, both in its unit.
struct ReferenceValue {
  double value, bound;
};

/// The values of fields, which must satisfy is_quantity(), of a swing like that of reference(); NaN
/// without a release. Loads take three times as long as the speed.
std::vector<ReferenceValue> reference_values(const Scene& scene, const Design<double>& design,
                                             const Solver& solver, std::span<const Field> fields);

/// The speed (m/s) of a release in extended precision, by vern8 at a tolerance; NaN without a
/// release within 100,000 steps. Of `solver`, max_time and the release are used.
double speed_in_extended_precision(const Scene& scene, const Design<double>& design,
                                   double tolerance, const Solver& solver);

}  // namespace trebsweep
