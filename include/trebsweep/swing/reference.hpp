#pragma once

#include <array>
#include <span>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// A design's swing as well as it can be known.
struct Reference {
  Status status;
  double speed;                      ///< m/s, NaN without a release
  long double release_time;          ///< s, NaN without a release
  std::array<long double, 6> state;  ///< at the end; the first four of a rigid sling
  double speed_bound;                ///< m/s: how far the speed can be off
  double time_bound;                 ///< s: how far the release time can be off
};

/// The swing in quadruple precision by fehlberg78, at two tolerances; their difference bounds the
/// error of the tighter one, which is the result. NaN where they disagree on the status. Of the
/// solver, its limits count.
Reference reference(const Scene& scene, const Design<double>& design, const Solver& solver);

}  // namespace trebsweep
