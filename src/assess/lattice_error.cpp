#include "trebsweep/assess/lattice_error.hpp"

#include <algorithm>
#include <cmath>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// The index of the largest number, ignoring NaN; 0 if all are NaN.
std::size_t index_of_largest(const std::vector<double>& values) {
  const auto less = [](double a, double b) { return !std::isnan(b) && !(a >= b); };
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end(), less) -
                                  values.begin());
}

}  // namespace

LatticeSpeeds lattice_speeds(const Scene& scene, const Solver& solver,
                             const std::vector<Design<double>>& designs, MPI_Comm comm) {
  // Assigned round-robin: neighbouring designs cost about the same, so contiguous blocks would be
  // unbalanced.
  const auto rank = static_cast<std::size_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  std::vector<Design<double>> own;
  for (std::size_t i = rank; i < designs.size(); i += ranks) own.push_back(designs[i]);
  std::vector<SwingResult> results(own.size());
  const double start = MPI_Wtime();
  integrate(scene, solver, {own, results});
  const double seconds = mpi::max(MPI_Wtime() - start, comm);
  std::vector<double> speeds(designs.size(), 0);
  for (std::size_t i = 0; i < own.size(); ++i) speeds[rank + i * ranks] = results[i].speed;
  MPI_Allreduce(MPI_IN_PLACE, speeds.data(), static_cast<int>(speeds.size()), MPI_DOUBLE, MPI_SUM,
                comm);
  return {std::move(speeds), seconds};
}

LatticeError lattice_error(const Scene& scene, const Solver& solver,
                           const std::vector<Design<double>>& designs,
                           const std::vector<double>& truth, MPI_Comm comm) {
  const auto [speeds, seconds] = lattice_speeds(scene, solver, designs, comm);
  LatticeError e{};
  e.seconds = seconds;
  std::vector<double> errors, relative;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    if (std::isnan(speeds[i]) != std::isnan(truth[i])) ++e.status_mismatches;
    if (std::isnan(speeds[i]) || std::isnan(truth[i])) continue;
    errors.push_back(std::abs(speeds[i] - truth[i]));
    relative.push_back((speeds[i] - truth[i]) / truth[i]);
  }
  e.speed = error_quantiles(std::move(errors));
  e.median_relative = error_quantiles(std::move(relative)).median;
  const std::size_t best = index_of_largest(speeds), true_best = index_of_largest(truth);
  e.best = designs[best];
  e.best_speed = speeds[best];
  e.optimum_error = speeds[true_best] - truth[true_best];
  return e;
}

}  // namespace trebsweep
