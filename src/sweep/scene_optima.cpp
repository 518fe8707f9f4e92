#include "trebsweep/sweep/scene_optima.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The objective of a design, by another stepper than the job's.
double accurate_value(const Job& job, const Design<double>& design) {
  const Expression& objective = job.optimum.objective;
  SwingResult result;
  std::vector<double> values(objective.fields.size());
  integrate_accurately(job.scene, checking_solver(job.scene, job.solver),
                       {{&design, 1}, {&result, 1}, objective.fields, values});
  return objective.value({job.scene, design, objective.fields, values});
}

/// By the job's solver or, with optimum.refine, accurately, as the search does.
BuildValues build_values(const Job& job, const Design<double>& design) {
  SwingResult result;
  std::array<double, build_fields.size()> values;
  const Batch batch{{&design, 1}, {&result, 1}, build_fields, values};
  if (job.optimum.refine)
    integrate_accurately(job.scene, solver_of("vern8", 1e-13, job.solver), batch);
  else
    integrate(job.scene, job.solver, batch);
  return to_build_values(values);
}

}  // namespace

BestDesign scene_optimum(const Job& job, const BestDesign& best, const Refine& refine) {
  BestDesign optimum = best;
  const auto refined = job.optimum.refine ? refine(job, best.design) : std::nullopt;
  if (refined)
    optimum = *refined;
  else if (job.solver.check)
    optimum.error = std::abs(best.value - accurate_value(job, best.design));
  optimum.build = build_values(job, optimum.design);
  return optimum;
}

}  // namespace trebsweep
