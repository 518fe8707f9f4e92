#pragma once

#include <cstdio>
#include <optional>
#include <vector>

#include "trebsweep/job/buildable.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// How a traced swing ends, and in what the design cannot be built.
struct Traced {
  Status status;
  std::vector<BuildProblem> problems;
};

// A table has comments with the heights of fulcrum and trough (m), the rule of release, the times
// of lift-off and release (s), and where and when the swing is closest to the ground (m) and the
// tensions of sling and hanger (N) are least; a header line; and a row per `interval` (s). Both
// functions throw InputError if r1 does not reach the start height, r3 does not reach the trough,
// or the interval is too short.

/// Prints one swing as a table, from the start to its end. The default interval is the step of a
/// fixed-step method, else 0.01 s.
///
/// Columns: t (s); phi1 and phi2 (rad), their rates w1 and w2 (rad/s), with a hanger also phi3 and
/// w3; x1 y1, xh yh (with a hanger), xt yt and x3 y3 (m, from the fulcrum) of counterweight, hinge,
/// tip of the throwing arm and projectile; speed of the projectile (m/s); energy (J); tension of
/// the sling at the projectile and tip_tension at the arm (N); force on the axle (N); magnitude of
/// the bending stress of the beam at the fulcrum (Pa), unless its section is not known;
/// hanger_tension (N) with a hanger; normal (N), the force of a trough on the projectile.
Traced trace(const Job& job, const Design<double>& design, std::optional<double> interval,
             std::FILE* out);

/// Prints the flight from the release to the impact as a table; without a flight, only its header.
/// The default interval is 0.01 s. Columns: t (s, from the start of the swing), x3 y3 (m, from the
/// fulcrum), vx vy and speed (m/s). Throws std::runtime_error if the integration takes more than
/// max_flight_steps.
Traced trace_flight(const Job& job, const Design<double>& design, std::optional<double> interval,
                    std::FILE* out);

}  // namespace trebsweep
