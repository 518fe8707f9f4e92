#include "trebsweep/swing/swing.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "trebsweep/swing/integrate.hpp"

namespace trebsweep {

SwingResult swing(const Scene& scene, const Design<double>& design, const Solver& solver,
                  ObservedSwing& observed, std::span<const Field> fields,
                  std::span<double> values) {
  SwingResult result;
  const Batch batch{{&design, 1}, {&result, 1}, fields, values};
  if (!observed.step || !takes_best_moment(solver.release)) {
    integrate_swings(scene, solver, batch, &observed);
    return result;
  }
  // The release is chosen from an interval: steps that follow it are left out.
  std::vector<std::pair<PlainInstant, PlainInstant>> taken;
  const auto observe =
      std::exchange(observed.step, [&](const PlainInstant& from, const PlainInstant& to) {
        taken.push_back({from, to});
      });
  integrate_swings(scene, solver, batch, &observed);
  observed.step = observe;
  for (const auto& [from, to] : taken) {
    const auto& [last_from, last_to] = taken.back();
    // Times of fixed steps differ by rounding errors.
    const bool is_last = std::abs(from.t - last_from.t) <= (to.t - from.t) / 2;
    observe(from, is_last ? last_to : to);
    if (is_last) break;
  }
  return result;
}

}  // namespace trebsweep
