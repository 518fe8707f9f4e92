#include "trebsweep/assess/assessment_cost.hpp"

#include <ctime>
#include <numeric>
#include <utility>
#include <vector>

#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/assess/measurement.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

/// The processor times that f(0), ..., f(n - 1) take, s, shared among the ranks. Collective.
template <class F>
std::vector<double> times(std::size_t n, MPI_Comm comm, F f) {
  return mpi::share(n, comm, [&](std::size_t i) {
    const std::clock_t start = std::clock();
    f(i);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  });
}

}  // namespace

AssessmentCost assessment_cost(const Job& job, bool overwrite, const std::string& own,
                               MPI_Comm comm) {
  // One setting in so many is measured: a prime, so that all steppers have their turn.
  constexpr std::size_t stride = 13;
  mpi::on_root(comm, [&] { reserve_output(job, overwrite, Reserve::no); });
  const std::vector<Case> cases = make_cases(job, own, comm);
  AssessmentCost cost{cases.size(), 0, 0, 0, 0};
  std::vector<std::pair<const Case*, Solver>> settings;
  for (const Case& c : cases) {
    cost.designs += c.designs.size();
    for (const Solver& solver : solvers(c, job.assess)) settings.emplace_back(&c, solver);
  }
  cost.settings = settings.size();
  const auto of_reference = times(cases.size(), comm, [&](std::size_t i) {
    const Case& c = cases[i];
    reference(c.job.scene, c.designs[c.designs.size() / 2], c.job.solver);
  });
  for (std::size_t i = 0; i < cases.size(); ++i)
    cost.reference_seconds += of_reference[i] * static_cast<double>(cases[i].designs.size());
  const auto of_setting = times((settings.size() + stride - 1) / stride, comm, [&](std::size_t i) {
    const auto& [c, solver] = settings[i * stride];
    const std::vector<Reference> unknown(c->designs.size());
    accuracy(c->job.scene, solver, c->designs, unknown, static_cast<int>(job.assess.repeats));
  });
  cost.setting_seconds = std::accumulate(of_setting.begin(), of_setting.end(), 0.0) *
                         static_cast<double>(settings.size()) /
                         static_cast<double>(of_setting.size());
  return cost;
}

}  // namespace trebsweep
