#include "trebsweep/swing/integrate.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "trebsweep/model/start.hpp"
#include "trebsweep/swing/advance.hpp"
#include "trebsweep/swing/spectrum.hpp"

namespace trebsweep {
namespace {

/// The values of a field that needs an integration of its own; `results` are those of the designs.
std::vector<double> separate_values(Field field, const Scene& scene, const Solver& solver,
                                    std::span<const Design<double>> designs,
                                    std::span<const SwingResult> results) {
  std::vector<double> values(designs.size());
  if (field == Field::speed_error) {
    std::vector<SwingResult> truth(designs.size());
    integrate_accurately(scene, checking_solver(scene, solver), {designs, truth});
    std::transform(results.begin(), results.end(), truth.begin(), values.begin(),
                   [](const SwingResult& a, const SwingResult& b) { return a.speed - b.speed; });
  } else {
    std::transform(designs.begin(), designs.end(), values.begin(), [&](const auto& design) {
      if (!start_is_reachable(scene, design) || !sling_reaches_trough(scene, design))
        return std::numeric_limits<double>::quiet_NaN();
      const auto [modulus, decay] = stiffness(spectra(scene, design, solver));
      return field == Field::stiffness ? modulus : decay;
    });
  }
  return values;
}

}  // namespace

Work integrate_swings(const Scene& scene, const Solver& solver, const Batch& batch,
                      ObservedSwing* observed) {
  if (is_for_packs(solver.stepper)) return integrate_packs(scene, solver, batch, observed);
  Work work{};
  for (std::size_t i = 0; i < batch.designs.size(); ++i) {
    const SingleStepper single = single_stepper(scene, batch.designs[i], solver);
    integrate_packs(scene, solver, batch.slice(i, 1), observed, &single);
    work.lane_steps += batch.results[i].steps;
    work.evaluations += single.evaluations();
  }
  return work;
}

Work integrate(const Scene& scene, const Solver& solver, const Batch& batch) {
  const std::span fields = batch.fields;
  const std::span results = batch.results;
  const bool computes = std::ranges::any_of(fields, is_of_swing);
  const Work work =
      integrate_swings(scene, solver, computes ? batch : Batch{batch.designs, results});
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const auto set = [&](auto value) {
      for (std::size_t i = 0; i < results.size(); ++i)
        batch.values[i * fields.size() + f] = static_cast<double>(value(i));
    };
    const Field field = fields[f];
    if (field == Field::speed) set([&](std::size_t i) { return results[i].speed; });
    if (field == Field::release_time) set([&](std::size_t i) { return results[i].release_time; });
    if (field == Field::status) set([&](std::size_t i) { return results[i].status; });
    if (field == Field::steps) set([&](std::size_t i) { return results[i].steps; });
    if (info(field).kind == FieldKind::separate) {
      const auto separate = separate_values(field, scene, solver, batch.designs, results);
      set([&](std::size_t i) { return separate[i]; });
    }
  }
  return work;
}

Solver checking_solver(const Scene& scene, const Solver& solver) {
  Solver checking = solver;
  // Where an elastic sling goes slack, the error estimate of fehlberg78 is blind: at 1e-13 its
  // speeds are wrong by up to 1e-5 m/s.
  const char* const other = scene.sling_stiffness == 0 ? "fehlberg78" : "dopri5";
  checking.stepper = solver.stepper == "vern8" ? other : "vern8";
  return checking;
}

void integrate_accurately(const Scene& scene, const Solver& solver, const Batch& batch) {
  const std::span designs = batch.designs;
  const std::span results = batch.results;
  std::vector<std::size_t> left(designs.size());  // to be integrated
  std::iota(left.begin(), left.end(), std::size_t{0});
  for (double tolerance = 1e-13; tolerance < 2e-10 && !left.empty(); tolerance *= 10) {
    std::vector<Design<double>> retried;
    for (const std::size_t i : left) retried.push_back(designs[i]);
    std::vector<SwingResult> found(left.size());
    std::vector<double> found_values(left.size() * batch.fields.size());
    const Batch part{retried, found, batch.fields, found_values};
    Solver accurate = solver_of(solver.stepper, tolerance, solver);
    accurate.max_steps = 100'000;
    integrate(scene, accurate, part);
    for (std::size_t k = 0; k < left.size(); ++k) {
      results[left[k]] = found[k];
      std::ranges::copy(part.slice(k, 1).values, batch.slice(left[k], 1).values.begin());
    }
    std::erase_if(left, [&](std::size_t i) {
      return results[i].status != Status::step_underflow &&
             results[i].status != Status::step_budget;
    });
  }
}

}  // namespace trebsweep
