#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "trebsweep/model/scene.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// What decides whether a design can be built: its least loads (N) and clearances (m) up to the
/// release; NaN without a release.
struct BuildValues {
  double least_sling_tension, least_hanger_tension;
  double tip_clearance, counterweight_clearance, projectile_clearance;
};

/// The fields that are the members of BuildValues, in their order.
inline constexpr std::array build_fields{Field::least_sling_tension, Field::least_hanger_tension,
                                         Field::tip_clearance, Field::counterweight_clearance,
                                         Field::projectile_clearance};

/// The values of a design from those of its fields, the first of which are build_fields.
BuildValues to_build_values(std::span<const double> values);

/// Why a design cannot be built.
enum class BuildFault { below_ground, slack_sling, compressed_hanger };

/// The same with body and amount: "the arm's tip reaches 0.15 m below the ground".
struct BuildProblem {
  BuildFault fault;
  std::string text;
};

/// In what a design of a scene cannot be built; empty for a buildable one. Rounding errors of the
/// values do not count.
std::vector<BuildProblem> build_problems(const Scene& scene, const BuildValues& values);

/// The texts of some problems on one line.
std::string to_text(std::span<const BuildProblem> problems);

}  // namespace trebsweep
