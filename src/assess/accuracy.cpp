#include "trebsweep/assess/accuracy.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Seconds per design.
double run_time(const Scene& scene, const Solver& solver, std::span<const Design<double>> sample,
                int repeats) {
  using Clock = std::chrono::steady_clock;
  constexpr std::size_t many = 512;    // fills all lanes for most of the time
  constexpr double long_enough = 0.3;  // s, for a single run to do
  const std::size_t least = is_for_packs(solver.stepper) ? 64 : 1;
  const auto seconds = [&](std::size_t count) {
    std::vector<Design<double>> designs;
    while (designs.size() < count) designs.insert(designs.end(), sample.begin(), sample.end());
    std::vector<SwingResult> results(designs.size());
    const auto start = Clock::now();
    integrate(scene, solver, {designs, results});
    return std::chrono::duration<double>(Clock::now() - start).count() /
           static_cast<double>(designs.size());
  };
  const double first = seconds(least);
  if (first * static_cast<double>(least) > long_enough) return first;
  const double fitting = long_enough / 10 / std::max(first, 1e-9);
  const auto count = static_cast<std::size_t>(
      std::clamp(fitting, static_cast<double>(least), static_cast<double>(many)));
  std::vector<double> runs;
  for (int i = 0; i < repeats; ++i) runs.push_back(seconds(count));
  return median(runs);
}

}  // namespace

ErrorQuantiles error_quantiles(std::vector<double> errors) {
  if (errors.empty()) return {nan, nan, nan};
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double part) {
    return errors[static_cast<std::size_t>(part * static_cast<double>(errors.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.95), errors.back()};
}

Accuracy accuracy(const Scene& scene, const Solver& solver, std::span<const Design<double>> designs,
                  std::span<const Reference> references, int repeats) {
  std::vector<SwingResult> results(designs.size());
  std::vector<double> drifts(designs.size());
  const std::array fields{Field::energy_drift};
  integrate(scene, solver, {designs, results, fields, drifts});
  const Work work = integrate(scene, solver, {designs, results});

  Accuracy a;
  std::vector<double> speed, relative, time, bounds;
  double steps = 0;
  a.drift = nan;
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
