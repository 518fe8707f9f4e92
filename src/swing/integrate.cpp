#include "trebsweep/swing/integrate.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

#include "trebsweep/ode/steppers.hpp"
#include "trebsweep/swing/kernel.hpp"
#include "trebsweep/swing/spectrum.hpp"
#include "trebsweep/swing/swings.hpp"

namespace trebsweep {
namespace {

/// integrate() without fields that are separate.
Work integrate_swings(const Scene& scene, const Solver& solver, const Batch& batch) {
  if (is_for_packs(solver.stepper)) return integrate_packs(scene, solver, batch);
  return with_effects(scene, [&]<Effects E>() {
    return with_stepper(
        solver.stepper, [&]<template <class, Effects = Effects{}> class Stepper>() {
          return swing_all<Stepper<double, E>, double, E>(scene, solver, batch);
        });
  });
}

/// A separate field of designs, whose shots are known.
std::vector<double> separate_values(Field field, const Scene& scene, const Solver& solver,
                                    std::span<const Design<double>> designs,
                                    std::span<const SwingResult> results) {
  std::vector<double> values(designs.size());
  if (field == Field::speed_error) {
    std::vector<SwingResult> truth(designs.size());
    integrate_swings(scene, accurate(solver), {designs, truth});
    std::transform(results.begin(), results.end(), truth.begin(), values.begin(),
                   [](const SwingResult& a, const SwingResult& b) { return a.speed - b.speed; });
  } else {
    std::transform(designs.begin(), designs.end(), values.begin(), [&](const auto& design) {
      if (!start_is_reachable(scene, design.r1)) return std::numeric_limits<double>::quiet_NaN();
      const auto [modulus, decay] = stiffness(spectra(scene, design, solver));
      return field == Field::stiffness ? modulus : decay;
    });
  }
  return values;
}

}  // namespace

Work integrate(const Scene& scene, const Solver& solver, const Batch& batch) {
  const auto& [designs, results, fields, values] = batch;
  std::vector<Field> swung;
  std::copy_if(fields.begin(), fields.end(), std::back_inserter(swung),
               [](Field field) { return !is_separate(field); });
  if (swung.size() == fields.size()) return integrate_swings(scene, solver, batch);

  std::vector<double> swung_values(designs.size() * swung.size());
  const Work work = integrate_swings(scene, solver, {designs, results, swung, swung_values});
  for (std::size_t f = 0, s = 0; f < fields.size(); ++f) {
    std::vector<double> separate;
    if (is_separate(fields[f]))
      separate = separate_values(fields[f], scene, solver, designs, results);
    for (std::size_t i = 0; i < designs.size(); ++i)
      values[i * fields.size() + f] =
          separate.empty() ? swung_values[i * swung.size() + s] : separate[i];
    if (separate.empty()) ++s;
  }
  return work;
}

Solver accurate(Solver solver) {
  solver.stepper = "fehlberg78";
  solver.tolerance = 1e-12;
  solver.release = Release::crossing;
  return solver;
}

}  // namespace trebsweep
