#include "trebsweep/optimum/maxima.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

std::vector<Found> search_from(const std::vector<Parameters>& starts, const Search& search,
                               ProgressStyle style, MPI_Comm comm) {
  Progress progress(0, starts.size(), style, "searches");
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  return mpi::share(starts.size(), comm, [&](std::size_t i) {
    Found found{};
    const ProblemOptimum end = search(starts[i], found.integrated);
    std::ranges::copy(end.point.x, found.x.begin());
    found.objective = end.point.objective;
    found.violation = end.point.violation;
    found.converged = end.converged;
    progress.update(std::min(i + ranks, starts.size()));
    return found;
  });
}

/// Orders feasible ends of searches, best first, and removes the others.
void sort_feasible(std::vector<Found>& found) {
  std::erase_if(found, std::not_fn(is_feasible<Found>));
  std::ranges::stable_sort(found, std::greater{}, &Found::objective);
}

}  // namespace

std::vector<Found> find_maxima(const std::vector<Parameters>& starts, const Search& search,
                               ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated) {
  std::vector<Found> found = search_from(starts, search, style, comm);
  for (const Found& f : found) integrated += f.integrated;
  sort_feasible(found);
  return found;
}

void merge(std::vector<Found>& found, const std::vector<Found>& more) {
  found.insert(found.end(), more.begin(), more.end());
  sort_feasible(found);
}

std::vector<Found> find_maxima(const std::vector<Parameters>& starts, const DesignProblem& problem,
                               ProgressStyle style, MPI_Comm comm, std::uint64_t& integrated) {
  constexpr std::size_t most = 4;  // thorough searches
  const auto search_with = [&](Effort effort) {
    return [&problem, effort](const Parameters& start, std::uint64_t& count) {
      return search(problem, start, effort, count);
    };
  };
  auto found = find_maxima(starts, search_with(Effort::quick), style, comm, integrated);
  // Thorough ones with variables take minutes; find_optimum() uses evolved() instead.
  if (!problem.machine.variables.empty()) return found;
  // A search that has stopped far below the best converged one seldom ends above it.
  constexpr double far = 0.1;
  const std::vector<LocalMaximum> ends = distinct(found, problem);
  const auto best = std::ranges::find_if(ends, &LocalMaximum::converged);
  const double least = best == ends.end() ? -HUGE_VAL : best->value - far * std::abs(best->value);
  std::vector<Parameters> stopped;
  for (const LocalMaximum& m : ends)
    if (!m.converged && m.value > least && stopped.size() < most) stopped.push_back(m.parameters);
  if (stopped.empty()) return found;
  std::erase_if(found, [&](const Found& f) {
    return !f.converged &&
           std::ranges::count(stopped, distinct({f}, problem).front().parameters) > 0;
  });
  merge(found, find_maxima(stopped, search_with(Effort::thorough), style, comm, integrated));
  return found;
}

std::vector<LocalMaximum> distinct(const std::vector<Found>& found, const DesignProblem& problem) {
  constexpr double same = 1e-4;  // m, or relative to the scale of a variable
  const Eigen::Index n = std::ssize(problem.free);
  Parameters units = Parameters::Ones(problem.space.size());
  for (Eigen::Index d = length_count; d < units.size(); ++d) units(d) = scale_of(problem.space, d);
  std::vector<LocalMaximum> maxima;
  for (const Found& f : found) {
    const LocalMaximum m{to_parameters(problem, Eigen::Map<const Eigen::VectorXd>(f.x.data(), n)),
                         f.objective * problem.scales.front(), 1, f.converged};
    const auto is_same = [&](const LocalMaximum& known) {
      return (known.parameters - m.parameters).cwiseQuotient(units).norm() < same;
    };
    if (const auto known = std::ranges::find_if(maxima, is_same); known != maxima.end())
      ++known->starts;
    else
      maxima.push_back(m);
  }
  return maxima;
}

}  // namespace trebsweep
