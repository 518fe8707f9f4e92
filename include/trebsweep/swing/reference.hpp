#pragma once

#include <array>
#include <span>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// A swing computed in quadruple precision.
struct Reference {
  Status status;
  double speed;                      ///< m/s, NaN without a release
  long double release_time;          ///< s, NaN without a release
  std::array<long double, 6> state;  ///< at the end; the first four of a rigid sling
  double speed_bound;                ///< m/s: bound of the error of `speed`
  double time_bound;                 ///< s: bound of the error of `release_time`
};

/// Integrates in quadruple precision by fehlberg78 with two tolerances. The result is that of the
/// tighter one; the difference bounds its error. The bounds are NaN where the statuses differ. Only
/// max_time and max_steps of `solver` are used.
Reference reference(const Scene& scene, const Design<double>& design, const Solver& solver);

}  // namespace trebsweep
