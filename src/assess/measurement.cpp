#include "trebsweep/assess/measurement.hpp"

#include <cmath>
#include <limits>

#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/ode/stepper_info.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// log(ratio of errors) / log(ratio of steps) of two settings; NaN if the steppers or the cases
/// differ.
double order_between(const Measurement& before, const Measurement& after) {
  if (before.test_case != after.test_case ||
      stepper_text(before.solver) != stepper_text(after.solver))
    return nan;
  return std::log(before.accuracy.speed.median / after.accuracy.speed.median) /
         std::log(after.accuracy.steps / before.accuracy.steps);
}

StepLimits step_limits(const Case& c, const std::string& stepper) {
  double largest = -1;
  std::vector<Spectrum> stiffest;
  std::size_t design = 0;
  for (std::size_t d = 0; d < c.designs.size(); ++d) {
    if (!has_speed(c.references[d].status)) continue;
    auto along_swing = spectra(c.job.scene, c.designs[d], c.job.solver);
    const double modulus = stiffness(along_swing).modulus;
    if (modulus <= largest) continue;
    largest = modulus;
    stiffest = std::move(along_swing);
    design = d;
  }
  if (stiffest.empty()) return {{nan, nan}, nan, nan};
  const double stable = largest_stable_step(stepper, stiffest);
  return {
      stiffness(stiffest), stable,
      largest_usable_step(stepper, c.job.scene, c.designs[design], c.references[design], stable)};
}

}  // namespace

std::string stepper_text(const Solver& solver) {
  return solver.stepper + (solver.release == Release::window ? ", window" : "");
}

std::vector<Solver> solvers(const Case& c, const Assessment& assessment) {
  std::vector<Solver> solvers{c.job.solver};
  for (const std::string& stepper : assessment.steppers) {
    const bool adaptive = follows_tolerance(stepper);
    std::vector<double> settings = adaptive ? assessment.tolerances : assessment.time_steps;
    if (c.extreme) settings = {adaptive ? c.job.solver.tolerance : c.job.solver.time_step};
    for (const double value : settings) solvers.push_back(solver_of(stepper, value, c.job.solver));
  }
  return solvers;
}

std::vector<Measurement> measure(const std::vector<Case>& cases, const Assessment& assessment,
                                 MPI_Comm comm) {
  std::vector<Measurement> measured;
  for (const Case& c : cases)
    for (const Solver& solver : solvers(c, assessment)) measured.push_back({&c, solver, {}, nan});
  const auto accuracies = mpi::share(measured.size(), comm, [&](std::size_t i) {
    const Case& c = *measured[i].test_case;
    return accuracy(c.job.scene, measured[i].solver, c.designs, c.references,
                    static_cast<int>(assessment.repeats));
  });
  for (std::size_t i = 0; i < measured.size(); ++i) {
    measured[i].accuracy = accuracies[i];
    if (i > 0) measured[i].order = order_between(measured[i - 1], measured[i]);
  }
  return measured;
}

std::vector<ConvergenceOrder> measure_orders(const Case& c, const Assessment& assessment,
                                             MPI_Comm comm) {
  std::vector<ConvergenceOrder> orders;
  for (const std::string& stepper : assessment.steppers)
    if (const int theory = info_of_stepper(stepper).order; theory > 0)
      orders.push_back({stepper, static_cast<double>(theory), nan});
  const auto observed = mpi::share(orders.size(), comm, [&](std::size_t i) {
    return observed_order(orders[i].stepper, c.job.scene, c.designs, c.references);
  });
  for (std::size_t i = 0; i < orders.size(); ++i) orders[i].observed = observed[i];
  return orders;
}

std::vector<StepLimitMeasurement> measure_step_limits(const std::vector<Case>& cases,
                                                      const Assessment& assessment, MPI_Comm comm) {
  std::vector<StepLimitMeasurement> measured;
  for (const Case& c : cases)
    for (const std::string& stepper : assessment.steppers)
      if (!c.extreme && has_stability_function(stepper)) measured.push_back({&c, stepper, {}});
  const auto limits = mpi::share(measured.size(), comm, [&](std::size_t i) {
    return step_limits(*measured[i].test_case, measured[i].stepper);
  });
  for (std::size_t i = 0; i < measured.size(); ++i) measured[i].limits = limits[i];
  return measured;
}

std::optional<std::vector<OscillationGrowth>> measure_growth(const Case& c,
                                                             const Assessment& assessment) {
  if (is_dissipative(c.job.scene) || effects(c.job.scene).elastic) return std::nullopt;
  std::vector<OscillationGrowth> growths;
  for (const std::string& stepper : assessment.steppers) {
    if (!has_stability_function(stepper)) continue;
    for (const double h : {assessment.time_steps.front(), assessment.time_steps.back()})
      growths.push_back(
          {stepper, h, growth(stepper, c.job.scene, c.designs.front(), h, oscillation_time)});
  }
  return growths;
}

std::optional<std::vector<LatticeMeasurement>> measure_lattice(
    const Case& c, const std::vector<Measurement>& measured, const Assessment& assessment,
    MPI_Comm comm) {
  const Lattice lattice(c.job.scene, c.job.lattice);
  if (assessment.lattice_seconds == 0 || lattice.designs() > 10'000'000) return std::nullopt;
  const auto designs = all_designs(lattice);
  const auto truth =
      lattice_speeds(c.job.scene, solver_of("vern8", 1e-13, c.job.solver), designs, comm);
  std::vector<LatticeMeasurement> errors;
  for (const Measurement& m : measured)
    if (m.test_case == &c && m.accuracy.seconds * static_cast<double>(designs.size()) <
                                 assessment.lattice_seconds * mpi::size(comm))
      errors.push_back(
          {m.solver, lattice_error(c.job.scene, m.solver, designs, truth.speeds, comm)});
  return errors;
}

}  // namespace trebsweep
