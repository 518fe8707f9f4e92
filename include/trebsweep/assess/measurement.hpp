#pragma once

#include <mpi.h>

#include <optional>
#include <string>
#include <vector>

#include "trebsweep/assess/accuracy.hpp"
#include "trebsweep/assess/cases.hpp"
#include "trebsweep/assess/lattice_error.hpp"
#include "trebsweep/assess/stability.hpp"

// What an assessment measures. Functions that take a communicator are collective and return the
// same on all ranks. The cases must outlive the results, which point to them.

namespace trebsweep {

/// A solver's accuracy on the sample of a case.
struct Measurement {
  const Case* test_case;
  Solver solver;
  MeasuredAccuracy accuracy;
  /// Observed order of convergence of the median speed error between the setting before and this
  /// one; NaN for a stepper's first setting.
  double order;
};

/// "euler", or "euler, window" with the paper's release window.
std::string stepper_text(const Solver& solver);

/// The solvers to measure on a case, its own and those of a stepper in a row.
std::vector<Solver> solvers(const Case& c, const Assessment& assessment);

/// Measures, on each case, its own solver and then each stepper of the assessment: at all settings,
/// or on an extreme case at the step or tolerance of the case's job.
std::vector<Measurement> measure(const std::vector<Case>& cases, const Assessment& assessment,
                                 MPI_Comm comm);

/// Order of convergence of a stepper with steps of equal length.
struct ConvergenceOrder {
  std::string stepper;
  double theory, observed;
};

/// Measures each stepper that has a fixed order.
std::vector<ConvergenceOrder> measure_orders(const Case& c, const Assessment& assessment,
                                             MPI_Comm comm);

/// Limits of a stepper's step on the stiffest design of a case; NaN if no design has a release.
struct StepLimits {
  Stiffness stiffness;
  double stable;  ///< largest_stable_step(), s
  double usable;  ///< largest_usable_step(), s
};

struct StepLimitMeasurement {
  const Case* test_case;
  std::string stepper;
  StepLimits limits;
};

/// Measures each stepper with a stability function on each case that is not extreme.
std::vector<StepLimitMeasurement> measure_step_limits(const std::vector<Case>& cases,
                                                      const Assessment& assessment, MPI_Comm comm);

/// Amplification of a small oscillation by a stepper with steps of length h (s).
struct OscillationGrowth {
  std::string stepper;
  double h;
  Growth growth;
};

inline constexpr double oscillation_time =
    10;  ///< s: duration of the integrations of measure_growth()

/// Measures each stepper with a stability function at the first and the last time step of the
/// assessment. Nothing if the scene is dissipative or has an elastic sling.
std::optional<std::vector<OscillationGrowth>> measure_growth(const Case& c,
                                                             const Assessment& assessment);

/// A solver's errors on the whole lattice of a case.
struct LatticeMeasurement {
  Solver solver;
  LatticeError error;
};

/// Measures those solvers of `measured` that are expected to finish within the assessment's
/// lattice_seconds. Nothing if that is 0 or the lattice has more than ten million designs.
std::optional<std::vector<LatticeMeasurement>> measure_lattice(
    const Case& c, const std::vector<Measurement>& measured, const Assessment& assessment,
    MPI_Comm comm);

}  // namespace trebsweep
