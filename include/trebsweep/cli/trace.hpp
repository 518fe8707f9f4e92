#pragma once

#include <cstdio>
#include <optional>

#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/status.hpp"

namespace trebsweep {

/// Prints one swing as a table: comments with the gravity, the height of the fulcrum and the rule
/// of release, a header line, a row per `interval` (s) from the start, and the end of the swing.
/// The default interval is the step of a fixed-step method, else 0.01 s.
///
/// Columns: t (s); phi1 and phi2 (rad), their rates w1 and w2 (rad/s); x1 y1, xt yt and x3 y3 (m,
/// from the fulcrum) of counterweight, tip of the throwing arm and projectile; speed of the
/// projectile (m/s); energy (J); tension of the sling at the projectile and tip_tension at the arm
/// (N); force on the axle (N); magnitude of the bending stress of the beam at the fulcrum (Pa).
/// Returns the outcome of the swing. Throws InputError if r1 does not reach the start height, or
/// the interval is too short.
Status trace(const Job& job, const Design<double>& design, std::optional<double> interval,
             std::FILE* out);

}  // namespace trebsweep
