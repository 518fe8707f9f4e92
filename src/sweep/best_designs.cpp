#include "trebsweep/sweep/best_designs.hpp"

#include <array>
#include <span>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The lengths of the best design of each scene, from rank 0's summary; zero without one.
std::vector<Design<double>> lengths(const Study& study, const Summary& summary, MPI_Comm comm) {
  std::vector<Design<double>> designs(study.scenes(), Design<double>{});
  if (mpi::rank(comm) == 0) {
    for (std::size_t scene = 0; scene < summary.optima.size(); ++scene)
      if (const SceneOptimum& optimum = summary.optima[scene]; optimum.exists())
        designs[scene] = {optimum.r1, optimum.r3, optimum.r2};
    if (!is_study(study.job())) {
      if (summary.refined)
        designs[0] = summary.refined->optimum.design;
      else if (summary.optimum)
        designs[0] = summary.optimum->design;
    }
  }
  mpi::merge(std::span(designs), comm);
  return designs;
}

BuildValues build_values(const Job& job, const Design<double>& design) {
  SwingResult result;
  std::array<double, build_fields.size()> values;
  const Batch batch{{&design, 1}, {&result, 1}, build_fields, values};
  if (job.optimum.refine)
    integrate_accurately(job.scene, job.solver, batch);
  else
    integrate(job.scene, job.solver, batch);
  return to_build_values(values);
}

}  // namespace

std::optional<std::vector<BestDesign>> best_designs(const Study& study, const Summary& summary,
                                                    const std::function<bool()>& stop,
                                                    MPI_Comm comm) {
  const std::vector<Design<double>> designs = lengths(study, summary, comm);
  std::vector<BestDesign> best(designs.size(), BestDesign{});
  const auto rank = static_cast<std::size_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  for (std::size_t scene = rank; scene < best.size() && !stop(); scene += ranks)
    if (designs[scene].r1 > 0)
      best[scene] = {designs[scene], build_values(job_at(study.job(), scene), designs[scene])};
  mpi::merge(std::span(best), comm);
  if (mpi::max(stop() ? 1 : 0, comm) > 0) return std::nullopt;
  return best;
}

}  // namespace trebsweep
