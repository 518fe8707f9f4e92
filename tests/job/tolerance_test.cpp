#include "trebsweep/job/tolerance.hpp"

#include <cmath>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/swing/integrate.hpp"

using namespace trebsweep;

namespace {

Job job_with_target(const std::string& stepper, double target) {
  Job job;
  job.lattice.increment = 0.02;
  job.solver = solver_of(stepper, 1e-9, job.solver);
  job.solver.target_error = target;
  return job;
}

}  // namespace

TEST_CASE("The tolerance for a target error meets it on the whole lattice without being too tight",
          "[slow]") {
  const Job any = job_with_target("vern8", 1e-9);
  const auto designs = all_designs(Lattice(any.scene, any.lattice));
  std::vector<SwingResult> results(designs.size()), reference(designs.size());
  integrate(any.scene, solver_of("fehlberg78", 1e-13, any.solver), {designs, reference});
  for (const std::string stepper : {"cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"})
    for (const double target : {1e-3, 1e-6, 1e-9}) {
      const Job job = job_with_target(stepper, target);
      const Solver chosen = solver_of(stepper, tolerance_for_target(job), job.solver);
      integrate(job.scene, chosen, {designs, results});
      double largest = 0;
      for (std::size_t i = 0; i < results.size(); ++i)
        largest = std::max(largest, std::abs(results[i].speed - reference[i].speed));
      INFO(stepper << " for " << target);
      CHECK(largest <= target);
      CHECK(largest > target / 1000);
    }
}

TEST_CASE(
    "The message about a target error that no tolerance meets gives the smallest possible one") {
  CHECK_THROWS_WITH(tolerance_for_target(job_with_target("dopri5", 1e-18)),
                    contains("solver.target-error = 1e-18: must be at least"));
}
