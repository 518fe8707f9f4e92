#pragma once

#include <cstdio>
#include <optional>

#include "trebsweep/job/job.hpp"
#include "trebsweep/swing/swings.hpp"

namespace trebsweep {

/// Prints one swing as a table: a header line, then a row per `interval` (s) from the start on, and
/// the swing's last moment. Without an interval: a row per step of a fixed stepper, else 0.01 s.
///
/// Columns: t (s); phi1, phi2 (rad) and their rates w1, w2 (rad/s); x and y (m, from the fulcrum)
/// of the counterweight (1), the throwing arm's tip (t) and the projectile (3); the projectile's
/// speed (m/s); the energy (J); the tension of the sling (N). Returns how the swing ended. Throws
/// InputError where r1 cannot reach the start.
Status trace(const Job& job, const Design<double>& design, std::optional<double> interval,
             std::FILE* out);

}  // namespace trebsweep
