#pragma once

#include <mpi.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trebsweep/archive/best_design.hpp"
#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/optimum/allowance.hpp"
#include "trebsweep/optimum/maxima.hpp"
#include "trebsweep/optimum/robust.hpp"
#include "trebsweep/optimum/sensitivity.hpp"

namespace trebsweep {

/// A constraint or bound that an optimum reaches.
struct ActiveLimit {
  std::string constraint;  ///< "r2 + r3 <= 1.5"
  std::string units;       ///< of the limit
  double multiplier;       ///< d optimum / d limit; of a robust optimum, of its worst or mean value
};

/// A field at the optimum.
struct BuildValue {
  Field field;
  double value;  ///< in the unit of the field
};

/// The range with less and with more wind in the direction of the throw than the scene has, m.
struct WindRange {
  static constexpr double speed = 5;  ///< by which the wind differs, m/s
  double less, more;
};

/// A better design than the optimum, next to which the objective jumps.
struct UnsafeDesign {
  Parameters parameters;
  double value;
};

/// The best design of a job.
struct OptimumResult {
  Expression objective;
  Parameters parameters;
  double value;  ///< of the objective
  /// Whether the objective is the negative distance to a target, which is met: derivatives, active
  /// limits and sensitivities do not exist there.
  bool is_on_target;
  double error;         ///< of the value: its distance from the value in extended precision
  double release_time;  ///< s
  /// Whether the conditions of Karush, Kuhn and Tucker hold. Not on a target, or where designs next
  /// to the optimum have no release.
  bool converged;
  bool has_kink;  ///< whether they hold at a kink of the objective: extremes of a swing are equal
  std::optional<UnsafeDesign> unsafe;  ///< if there is one, the optimum is the best safe design
  std::vector<BuildValue> values;      ///< what a builder needs to know
  std::vector<ActiveLimit> active;     ///< empty if not converged
  Eigen::VectorXd gradient;            ///< of the objective, with respect to the parameters
  Eigen::MatrixXd hessian;
  std::vector<Allowance> allowances;          ///< of the parameters
  std::vector<std::array<double, 2>> bounds;  ///< of each parameter, with the others as they are
  std::optional<Allowance> pin_allowance;     ///< unless no pin makes the release
  std::optional<WindRange> range_with_wind;   ///< of a projectile that feels drag, with that pin
  /// By the keys of the scene, without the section.
  std::vector<std::pair<std::string, Sensitivity>> sensitivities;
  std::optional<Robustness> robustness;  ///< under the job's deviation, if it has one
  std::vector<LocalMaximum> maxima;      ///< best first; the optimum is the first one
  double coarse_increment;               ///< m
  std::uint64_t starts;                  ///< number of continuous searches
  std::uint64_t designs;                 ///< integrated
  double seconds;
};

struct OptimumOptions {
  bool own_lattice = false;  ///< whether the coarse sweep is of the job's lattice
  ProgressStyle progress = ProgressStyle::none;
  std::vector<Parameters> starts = {};  ///< to search from besides those of the coarse sweep
};

/// Searches for the optimum of a job, which is_safe(): a coarse sweep of the job's own lattice or
/// of coarse_lattice(), then continuous searches from its best local maxima and, with variables,
/// from evolved() ones unless most searches agree. Every design is integrated accurately by vern8
/// to the solver's located() release. Returns the result on rank 0. Throws NoOptimum on all ranks
/// if the design space is empty, nothing is released, no design satisfies the constraints, none
/// that does is safe, or the objective grows without limit towards an open bound. Collective.
std::optional<OptimumResult> find_optimum(const Job& job, const OptimumOptions& options,
                                          MPI_Comm comm);

/// The optimum of a job's design space that a search from a design of its lattice reaches; nothing
/// if that is not feasible. The error is the difference from another stepper, both at a tolerance
/// of 1e-13.
std::optional<BestDesign> refine(const Job& job, const Design<double>& start);

}  // namespace trebsweep
