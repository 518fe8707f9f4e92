#include "trebsweep/optimum/design_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace trebsweep {
namespace {

using Eigen::Index;

/// The scenes at the corners of the box of a job's variables. The bounds of the lengths in any
/// scene are between those of two corners, because they are linear or monotonic in each variable.
std::vector<Scene> corner_scenes(const Job& job) {
  std::vector<Scene> scenes;
  for (const std::vector<double>& values : corners(job.optimum.variables)) {
    Job at = job;
    set_variables(job.optimum.variables, values, at.scene, at.solver);
    scenes.push_back(at.scene);
  }
  return scenes;
}

/// The bounds of r1 (47) that hold in all scenes, and limits where they differ among the scenes.
ArmBounds widest_arm_bounds(const std::vector<Scene>& scenes, std::vector<SpaceLimit>& limits) {
  ArmBounds widest = arm_bounds(scenes.front());
  double largest_low = widest.low, smallest_high = widest.high;
  for (const Scene& scene : scenes) {
    const ArmBounds arm = arm_bounds(scene);
    if (arm.low > largest_low) widest.low_text = arm.low_text;
    widest.low = std::min(widest.low, arm.low);
    largest_low = std::max(largest_low, arm.low);
    widest.high = std::max(widest.high, arm.high);
    smallest_high = std::min(smallest_high, arm.high);
  }
  if (widest.low < largest_low)
    limits.push_back({"r1 >= " + widest.low_text, [](const Scene& s, const Design<double>& d) {
                        return arm_bounds(s).low - d.r1;
                      }});
  if (smallest_high < widest.high)
    limits.push_back({"r1 <= " + widest.high_text, [](const Scene& s, const Design<double>& d) {
                        return d.r1 - arm_bounds(s).high;
                      }});
  return widest;
}

}  // namespace

Design<double> to_design(const Eigen::Ref<const Parameters>& parameters) {
  return {.r1 = parameters(0), .r3 = parameters(1), .r2 = parameters(2)};
}

Parameters to_parameters(const Design<double>& design) {
  return Eigen::Vector3d(design.r1, design.r3, design.r2);
}

std::string to_text(const Parameters& parameters, std::span<const Variable> variables,
                    UnitSystem units) {
  const ShownUnit length = shown_unit("m", units);
  const Eigen::Vector3d r = parameters.head(length_count) / length.factor;
  std::string text =
      fmt::format("r1 = {:.7f}, r2 = {:.7f}, r3 = {:.7f} {}", r(0), r(2), r(1), length.name);
  for (Index i = length_count; const Variable& variable : variables) {
    const auto [unit, factor] = shown_unit(unit_of(variable), units);
    text += fmt::format(", {} = {:.7g}{}{}", variable.name(), parameters(i++) / factor,
                        unit.empty() ? "" : " ", unit);
  }
  return text;
}

Job with_variables(Job job, const Eigen::Ref<const Eigen::VectorXd>& values) {
  set_variables(job.optimum.variables, {values.data(), job.optimum.variables.size()}, job.scene,
                job.solver);
  return job;
}

DesignSpace design_space(const Job& job) {
  const LatticeSpec& spec = job.lattice;
  const std::vector<Scene> scenes = corner_scenes(job);
  const auto [lowest, highest] =
      std::ranges::minmax(scenes, {}, [](const Scene& s) { return s.fulcrum_height; });
  const double h0 = highest.fulcrum_height;
  const double shortest = spec.r3 ? spec.r3->first : spec.shortest_sling;
  DesignSpace space{{"r1", "r3", "r2"}, {"m", "m", "m"}, {}, {}, {}};
  std::vector<SpaceLimit> arm_limits;
  const ArmBounds arm = widest_arm_bounds(scenes, arm_limits);
  if (!spec.r1) space.limits = arm_limits;

  std::vector<double> lower{arm.low, shortest, 0}, upper{arm.high, h0, h0};
  const std::array<std::string, 3> lower_text{arm.low_text, "lattice.shortest-sling", "0"};
  const std::array<std::string, 3> upper_text{arm.high_text, "h0", "h0"};
  const std::array axes{&spec.r1, &spec.r3, &spec.r2};
  for (std::size_t d = 0; d < 3; ++d)
    if (const auto& range = *axes[d]) {
      lower[d] = range->first;
      upper[d] = range->last;
    } else if (!(lower[d] < upper[d])) {
      throw NoOptimum(fmt::format(
          "the design space is empty: {0} must be longer than {1} = {2:.6g} m and shorter than {3} "
          "= {4:.6g} m",
          space.names[d], lower_text[d], lower[d], upper_text[d], upper[d]));
    }
  if (!spec.r2)
    space.limits.push_back(
        {lowest.fulcrum_height < h0 ? "r2 + r3 <= h0" : fmt::format("r2 + r3 <= {:.9g}", h0),
         [](const Scene& s, const Design<double>& d) { return d.r2 + d.r3 - s.fulcrum_height; }});
  for (const Variable& variable : job.optimum.variables) {
    space.names.push_back(variable.name());
    space.units.push_back(unit_of(variable));
    lower.push_back(variable.lower);
    upper.push_back(variable.upper);
  }
  space.lower = Parameters::Map(lower.data(), std::ssize(lower));
  space.upper = Parameters::Map(upper.data(), std::ssize(upper));
  return space;
}

}  // namespace trebsweep
