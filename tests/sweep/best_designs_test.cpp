#include "trebsweep/sweep/best_designs.hpp"

#include <array>
#include <cmath>
#include <span>

#include "support/catch.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

constexpr Design<double> coarse{0.6, 0.6, 0.8}, between{0.55, 0.58, 0.9};

const auto never = [] { return false; };

/// Of rank 0; that of others is empty.
Summary only_on_root(const Summary& summary) {
  return mpi::rank(MPI_COMM_WORLD) == 0 ? summary : Summary{};
}

/// The least tension of the sling by a function that integrates.
double least_tension(decltype(integrate_accurately) integrate_by, const Job& job,
                     const Design<double>& design) {
  constexpr std::array fields{Field::least_sling_tension};
  SwingResult result;
  double value = 0;
  integrate_by(job.scene, job.solver, {{&design, 1}, {&result, 1}, fields, {&value, 1}});
  return value;
}

void by_the_solver(const Scene& scene, const Solver& solver, const Batch& batch) {
  integrate(scene, solver, batch);
}

}  // namespace

TEST_CASE("The best design of one scene is that of its lattice, or the refined one") {
  Job job;
  job.solver.tolerance = 1e-4;
  Summary summary;
  summary.optimum = Optimum{coarse, 1, 1, 1};
  auto best = best_designs(Study(job), only_on_root(summary), never, MPI_COMM_WORLD);
  REQUIRE(best->size() == 1);
  CHECK(best->front().design == coarse);
  CHECK(best->front().build.least_sling_tension == least_tension(by_the_solver, job, coarse));

  job.optimum.refine = true;
  summary.refined = RefinedOptimum{Optimum{between, 2, 2, 1}, 0};
  best = best_designs(Study(job), only_on_root(summary), never, MPI_COMM_WORLD);
  CHECK(best->front().design == between);
  const double accurate = least_tension(integrate_accurately, job, between);
  CHECK(best->front().build.least_sling_tension == accurate);
  CHECK(accurate != least_tension(by_the_solver, job, between));
}

TEST_CASE("Without an optimum there is no best design") {
  const auto best = best_designs(Study(Job()), Summary{}, never, MPI_COMM_WORLD);
  REQUIRE(best->size() == 1);
  CHECK_FALSE(best->front().exists());
}

TEST_CASE("The best designs of a study are those of its scenes, each integrated in its own") {
  Job job;
  job.outer_axes = {{"scene.fulcrum-height", {1.6, 1.7, 1.8, 1.9}, "1.6:1.9:0.1"}};
  Summary summary;
  summary.optima.resize(4);
  for (const std::size_t scene : {0, 2, 3}) {
    SceneOptimum& optimum = summary.optima[scene];
    optimum.value = optimum.speed = 1;
    optimum.r1 = 0.8;
    optimum.r3 = optimum.r2 = 0.1 * static_cast<double>(scene + 3);
  }
  const auto best = best_designs(Study(job), only_on_root(summary), never, MPI_COMM_WORLD);
  REQUIRE(best->size() == 4);
  for (const std::size_t scene : {0, 2, 3}) {
    const double length = 0.1 * static_cast<double>(scene + 3);
    CHECK((*best)[scene].design == Design<double>{0.8, length, length});
    const Job own = job_at(job, scene);
    CHECK((*best)[scene].build.least_sling_tension ==
          least_tension(by_the_solver, own, (*best)[scene].design));
    CHECK((*best)[scene].build.counterweight_clearance ==
          Approx(own.scene.fulcrum_height - 0.8).margin(1e-6));
  }
  CHECK_FALSE((*best)[1].exists());
}

TEST_CASE("A stop on any rank leaves the best designs out on all") {
  const auto on_last = [] { return mpi::rank(MPI_COMM_WORLD) + 1 == mpi::size(MPI_COMM_WORLD); };
  CHECK_FALSE(best_designs(Study(Job()), Summary{}, on_last, MPI_COMM_WORLD));
}
