#include "trebsweep/assess/cases.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/job/load_job.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The fastest design of a lattice, found by integrating every design with dopri5 at a tolerance of
/// 1e-7; nothing if the lattice has more than a million designs, or no release. Collective.
std::optional<Design<double>> optimum(const Job& job, const Lattice& lattice, MPI_Comm comm) {
  if (lattice.designs() > 1'000'000) return std::nullopt;
  const auto designs = all_designs(lattice);
  constexpr std::size_t part = 4096;  // designs
  struct Best {
    double speed;
    std::size_t index;
  };
  const auto slower = [](const Best& a, const Best& b) { return a.speed < b.speed; };
  const auto bests = mpi::share((designs.size() + part - 1) / part, comm, [&](std::size_t p) {
    const std::size_t first = p * part;
    const auto some = std::span(designs).subspan(first, std::min(part, designs.size() - first));
    std::vector<SwingResult> results(some.size());
    integrate(job.scene, solver_of("dopri5", 1e-7, job.solver), {some, results});
    Best best{-1, first};
    for (std::size_t i = 0; i < results.size(); ++i)
      if (has_speed(results[i].status))
        best = std::max(best, {results[i].speed, first + i}, slower);
    return best;
  });
  const Best best = *std::max_element(bests.begin(), bests.end(), slower);
  if (best.speed < 0) return std::nullopt;
  return designs[best.index];
}

Case make_case(const std::string& name, const Job& job, bool extreme, std::size_t count,
               MPI_Comm comm) {
  const Lattice lattice(job.scene, job.lattice);
  Case c{name, job, extreme, sample(lattice, count), {}};
  if (const auto best = optimum(job, lattice, comm)) {
    std::erase(c.designs, *best);
    c.designs.insert(c.designs.begin(), *best);
  }
  return c;
}

}  // namespace

std::vector<Case> make_cases(const Job& job, const std::string& own, MPI_Comm comm) {
  std::vector<Case> cases;
  const auto add = [&](const std::vector<std::string>& paths, bool extreme) {
    for (const std::string& path : paths) {
      const Job scene = load_job(path, job.assess.overrides, comm);
      require_one_scene(scene, "assess takes one scene from each file, also from " + path);
      cases.push_back(make_case(job_name(path), scene, extreme, job.assess.designs, comm));
    }
  };
  add(job.assess.scenes, false);
  if (cases.empty() && job.assess.extremes.empty())
    cases.push_back(make_case(own, job, false, job.assess.designs, comm));
  add(job.assess.extremes, true);
  return cases;
}

void compute_references(std::vector<Case>& cases, MPI_Comm comm) {
  struct Index {
    std::size_t test_case, design;
  };
  std::vector<Index> indices;
  for (std::size_t c = 0; c < cases.size(); ++c)
    for (std::size_t d = 0; d < cases[c].designs.size(); ++d) indices.push_back({c, d});
  const auto references = mpi::share(indices.size(), comm, [&](std::size_t i) {
    const Case& c = cases[indices[i].test_case];
    return reference(c.job.scene, c.designs[indices[i].design], c.job.solver);
  });
  for (std::size_t i = 0; i < indices.size(); ++i)
    cases[indices[i].test_case].references.push_back(references[i]);
}

}  // namespace trebsweep
