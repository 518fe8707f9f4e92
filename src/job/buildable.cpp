#include "trebsweep/job/buildable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "trebsweep/swing/flight.hpp"

namespace trebsweep {

BuildValues to_build_values(std::span<const double> values) {
  return {values[0], values[1], values[2], values[3], values[4]};
}

std::vector<BuildProblem> build_problems(const Scene& scene, const BuildValues& values) {
  std::vector<BuildProblem> problems;
  const auto add = [&](BuildFault fault, const std::string& text) {
    problems.emplace_back() = {fault, text};
  };
  const auto check_height = [&](const char* body, double height) {
    if (height < -ground_rounding)
      add(BuildFault::below_ground,
          fmt::format("{} reaches {:.2g} m below the ground", body, -height));
  };
  check_height("the arm's tip", values.tip_clearance);
  check_height("the counterweight", values.counterweight_clearance);
  check_height("the projectile", values.projectile_clearance);

  // So little of the weight counts as zero, such as the tension of a horizontal sling at rest, or
  // one at a limit that a search has reached.
  constexpr double rounding = 1e-6;
  const double sling = values.least_sling_tension, hanger = values.least_hanger_tension;
  if (scene.sling_stiffness > 0) {
    if (sling <= 0) add(BuildFault::slack_sling, "the sling goes slack");
  } else if (sling < -rounding * scene.projectile_mass * scene.gravity) {
    add(BuildFault::slack_sling,
        fmt::format("the sling goes slack: to stay straight, it would have to push with {:.3g} N",
                    -sling));
  }
  if (hanger < -rounding * scene.counterweight_mass * scene.gravity)
    add(BuildFault::compressed_hanger,
        fmt::format("the counterweight's hanger is under a compression of {:.3g} N", -hanger));
  return problems;
}

std::string to_text(std::span<const BuildProblem> problems) {
  std::vector<std::string> texts;
  for (const BuildProblem& problem : problems) texts.push_back(problem.text);
  return fmt::format("{}", fmt::join(texts, "; "));
}

}  // namespace trebsweep
