#include "trebsweep/assess/accuracy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <vector>

#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

/// Run time per design, s.
double run_time(const Scene& scene, const Solver& solver, std::span<const Design<double>> sample,
                int repeats) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t max_designs = 512;  // enough to keep the lanes full most of the time
  constexpr double long_enough = 0.3;       // s: a run of this length need not be repeated
  const std::size_t min_designs = is_for_packs(solver.stepper) ? 64 : 1;
  const auto seconds_per_design = [&](std::size_t count) {
    std::vector<Design<double>> designs;
    while (designs.size() < count) designs.insert(designs.end(), sample.begin(), sample.end());
    std::vector<SwingResult> results(designs.size());
    const auto start = Clock::now();
    integrate(scene, solver, {designs, results});
    return std::chrono::duration<double>(Clock::now() - start).count() /
           static_cast<double>(designs.size());
  };
  const double first = seconds_per_design(min_designs);
  if (first * static_cast<double>(min_designs) > long_enough) return first;
  const auto count = static_cast<std::size_t>(std::clamp(long_enough / 10 / std::max(first, 1e-9),
                                                         static_cast<double>(min_designs),
                                                         static_cast<double>(max_designs)));
  std::vector<double> runs;
  for (int i = 0; i < repeats; ++i) runs.push_back(seconds_per_design(count));
  return error_quantiles(std::move(runs)).median;
}

}  // namespace

MeasuredAccuracy accuracy(const Scene& scene, const Solver& solver,
                          std::span<const Design<double>> designs,
                          std::span<const Reference> references, int repeats) {
  std::vector<SwingResult> results(designs.size());
  std::vector<double> drifts(designs.size());
  const std::array fields{Field::energy_drift};
  integrate(scene, solver, {designs, results, fields, drifts});
  const Work work = integrate(scene, solver, {designs, results});

  MeasuredAccuracy a;
  std::vector<double> speed, relative, time, bounds;
  double steps = 0;
  a.drift = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const SwingResult& result = results[i];
    const Reference& truth = references[i];
    ++a.statuses[static_cast<std::size_t>(result.status)];
    steps += static_cast<double>(result.steps);
    if (has_speed(result.status) != has_speed(truth.status)) ++a.status_mismatches;
    if (!has_speed(result.status) || !has_speed(truth.status)) continue;
    speed.push_back(std::abs(result.speed - truth.speed));
    relative.push_back(speed.back() / truth.speed);
    time.push_back(std::abs(result.release_time - static_cast<double>(truth.release_time)));
    bounds.push_back(truth.speed_bound);
    a.drift = std::fmax(a.drift, std::abs(drifts[i]));
  }
  a.speed = error_quantiles(std::move(speed));
  a.relative = error_quantiles(std::move(relative));
  a.time = error_quantiles(std::move(time));
  a.reference_error = error_quantiles(std::move(bounds)).median;
  const auto count = static_cast<double>(designs.size());
  a.steps = steps / count;
  a.evaluations = static_cast<double>(work.evaluations) / count;
  a.seconds = run_time(scene, solver, designs, repeats);
  return a;
}

}  // namespace trebsweep
