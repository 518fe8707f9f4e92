#include "trebsweep/archive/best_design.hpp"

#include <tuple>

namespace trebsweep {

const BestDesign& better(const BestDesign& a, const BestDesign& b) {
  if (!a.exists() || !b.exists()) return a.exists() ? a : b;
  const auto place = [](const Design<double>& d) { return std::tuple(d.r1, d.r3, d.r2); };
  if (a.value == b.value) return place(a.design) < place(b.design) ? a : b;
  return a.value > b.value ? a : b;
}

std::optional<std::uint64_t> best_scene(std::span<const BestDesign> of_scenes) {
  std::optional<std::uint64_t> best;
  for (std::uint64_t scene = 0; scene < of_scenes.size(); ++scene)
    if (of_scenes[scene].exists() && (!best || of_scenes[scene].value > of_scenes[*best].value))
      best = scene;
  return best;
}

BestNumbers to_numbers(const BestDesign& best) {
  const auto& [r1, r3, r2] = best.design;
  return {best.value, best.speed, r1, r3, r2, best.release_time, best.error};
}

BestDesign to_best_design(const BestNumbers& numbers) {
  const auto& [value, speed, r1, r3, r2, release_time, error] = numbers;
  return {.value = value,
          .speed = speed,
          .design = {r1, r3, r2},
          .release_time = release_time,
          .error = error};
}

}  // namespace trebsweep
