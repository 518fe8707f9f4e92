#include "trebsweep/sweep/scene_optima.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/objective.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The objective of a design, integrated accurately.
double accurate_value(const Job& job, const Design<double>& design) {
  const std::vector<Field> fields = additional_fields({job.optimum.objective});
  std::vector<SwingResult> results(1);
  std::vector<double> values(fields.size());
  const Batch batch{{&design, 1}, results, fields, values};
  integrate_accurately(job.scene, job.solver, batch);
  double value = 0;
  for_each_value(batch, job.optimum.objective, [&](std::size_t, double v) { value = v; });
  return value;
}

SceneOptimum to_scene_optimum(const Optimum& optimum, double error) {
  const auto& [r1, r3, r2] = optimum.design;
  return {optimum.value, optimum.speed, r1, r3, r2, optimum.release_time, error};
}

}  // namespace

SceneOptimum scene_optimum(const Job& job, const Optimum& optimum, const Refine& refine) {
  if (job.optimum.refine)
    if (const auto refined = refine(job, optimum.design))
      return to_scene_optimum(refined->optimum, refined->error);
  const double error = job.solver.check
                           ? std::abs(optimum.value - accurate_value(job, optimum.design))
                           : std::numeric_limits<double>::quiet_NaN();
  return to_scene_optimum(optimum, error);
}

}  // namespace trebsweep
