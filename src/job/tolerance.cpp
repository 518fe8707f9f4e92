#include "trebsweep/job/tolerance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The largest difference in speed, m/s; infinity if a design has a release in one of them only.
double largest_difference(const std::vector<SwingResult>& results,
                          const std::vector<SwingResult>& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (has_speed(results[i].status) != has_speed(reference[i].status)) return infinity;
    if (has_speed(results[i].status))
      largest = std::max(largest, std::abs(results[i].speed - reference[i].speed));
  }
  return largest;
}

}  // namespace

double tolerance_for_target(const Job& job) {
  constexpr double safety = 4;
  const auto designs = sample(Lattice(job.scene, job.lattice), 128);
  const auto integrate_with = [&](const Solver& solver) {
    std::vector<SwingResult> results(designs.size());
    integrate(job.scene, solver, {designs, results});
    return results;
  };
  const auto reference = integrate_with(solver_of("dopri5", 1e-14, job.solver));
  // From tight to loose, until the error exceeds the target.
  double chosen = 0, smallest = infinity;
  for (int exponent = 26; exponent >= 6; --exponent) {
    const double tolerance = std::pow(10, -exponent / 2.0);
    const auto results = integrate_with(solver_of(job.solver.stepper, tolerance, job.solver));
    const double error = safety * largest_difference(results, reference);
    smallest = std::min(smallest, error);
    if (error <= job.solver.target_error)
      chosen = tolerance;
    else if (chosen > 0)
      break;
  }
  if (!std::isfinite(smallest))
    refuse("solver.target-error", fmt::format("{}", job.solver.target_error),
           "left out: whether some designs have a release depends on the tolerance, or on "
           "solver.max-steps; give solver.tolerance instead");
  if (chosen == 0)
    refuse("solver.target-error", fmt::format("{}", job.solver.target_error),
           fmt::format("at least {:.1g} m/s, which {} can reach in this scene", smallest,
                       job.solver.stepper));
  return chosen;
}

}  // namespace trebsweep
