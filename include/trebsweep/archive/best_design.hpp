#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "trebsweep/job/buildable.hpp"
#include "trebsweep/model/scene.hpp"

namespace trebsweep {

/// The best of some designs of a scene: the one with the largest objective among those that are
/// released and satisfy the job's constraints. Without one, all members are NaN; so is a
/// member that is not known.
struct BestDesign {
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  double value = nan;  ///< the objective, in the unit of its field
  double speed = nan;  ///< m/s
  Design<double> design{nan, nan, nan};
  double release_time = nan;  ///< s
  double error = nan;         ///< of the value, in its unit
  BuildValues build{nan, nan, nan, nan, nan};

  bool exists() const { return !std::isnan(value); }
};

/// The better of two, a reference to one of them; if both are equally good, the first in the
/// lattice.
const BestDesign& better(const BestDesign& a, const BestDesign& b);

/// The number of the scene with the best design, the first of equal ones; nothing if none has one.
std::optional<std::uint64_t> best_scene(std::span<const BestDesign> of_scenes);

/// The members that an archive stores, in this order.
inline constexpr std::array<std::string_view, 7> best_names{
    "best_value", "best_speed", "best_r1", "best_r3", "best_r2", "best_release_time", "best_error"};
using BestNumbers = std::array<double, best_names.size()>;

BestNumbers to_numbers(const BestDesign& best);
BestDesign to_best_design(const BestNumbers& numbers);

}  // namespace trebsweep
