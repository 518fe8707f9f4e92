#include "trebsweep/sweep/scene_optima.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/objective.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The optima of the lattices, from rank 0's tallies; all zero for a scene without one.
std::vector<Optimum> lattice_optima(const Study& study, std::uint64_t count,
                                    std::span<const Tally> tallies, MPI_Comm comm) {
  std::vector<Optimum> optima(count, Optimum{});
  if (mpi::rank(comm) == 0)
    for (std::uint64_t n = 0; n < count; ++n) {
      const Tally& tally = tallies[n];
      if (tally.best_cell == no_cell) continue;
      const auto [scene, design] = study.design(tally.best_cell);
      optima[n] = {design, tally.best_value, tally.best_speed, tally.best_time, scene};
    }
  mpi::merge(std::span(optima), comm);
  return optima;
}

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

/// The optimum of a scene whose lattice has one.
SceneOptimum scene_optimum(const Job& job, const Optimum& optimum, const Refine& refine) {
  if (job.optimum.refine)
    if (const auto refined = refine(job, optimum.design))
      return to_scene_optimum(refined->optimum, refined->error);
  const double error = job.solver.check
                           ? std::abs(optimum.value - accurate_value(job, optimum.design))
                           : std::numeric_limits<double>::quiet_NaN();
  return to_scene_optimum(optimum, error);
}

}  // namespace

std::optional<std::vector<SceneOptimum>> scene_optima(
    const Study& study, std::uint64_t first, std::uint64_t count, std::span<const Tally> tallies,
    const Refine& refine, const std::function<bool()>& stop, MPI_Comm comm) {
  const std::vector<Optimum> lattice = lattice_optima(study, count, tallies, comm);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  std::vector<SceneOptimum> own(count);
  mpi::on_all(comm, [&] {
    for (std::uint64_t n = rank; n < count && !stop(); n += ranks) {
      const bool exists = lattice[n].design.r1 != 0;
      if (exists) own[n] = scene_optimum(job_at(study.job(), first + n), lattice[n], refine);
    }
  });
  if (mpi::max(stop() ? 1 : 0, comm) > 0) return std::nullopt;
  return mpi::share(count, comm, [&](std::uint64_t n) { return own[n]; });
}

}  // namespace trebsweep
