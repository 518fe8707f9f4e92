#include "trebsweep/optimum/design_space.hpp"

#include <fmt/format.h>

#include <string>

namespace trebsweep {

std::string to_text(const Design<double>& design) {
  return fmt::format("r1 = {:.7f}, r2 = {:.7f}, r3 = {:.7f} m", design.r1, design.r2, design.r3);
}

DesignSpace design_space(const Scene& scene, const LatticeSpec& spec) {
  const ArmBounds arm = arm_bounds(scene);
  const double h0 = scene.fulcrum_height;
  const double shortest = spec.r3 ? spec.r3->first : spec.shortest_sling;
  DesignSpace space{{arm.low, shortest, 0}, {arm.high, h0, h0}, h0};
  const std::array<std::string, 3> lower_text{arm.low_text, "lattice.shortest-sling", "0"};
  const std::array<std::string, 3> upper_text{arm.high_text, "h0", "h0"};
  const std::array axes{&spec.r1, &spec.r3, &spec.r2};
  for (std::size_t d = 0; d < 3; ++d)
    if (const auto& range = *axes[d]) {
      space.lower[d] = range->first;
      space.upper[d] = range->last;
    }
  if (spec.r2) space.longest_sum = std::nullopt;
  for (std::size_t d = 0; d < 3; ++d)
    if (!*axes[d] && !(space.lower[d] < space.upper[d]))
      throw NoOptimum(fmt::format(
          "the design space is empty: {0} must be longer than {1} = {2:.6g} m and shorter than {3} "
          "= {4:.6g} m",
          length_names[d], lower_text[d], space.lower[d], upper_text[d], space.upper[d]));
  return space;
}

}  // namespace trebsweep
