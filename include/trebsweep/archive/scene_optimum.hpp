#pragma once

#include <hdf5.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "trebsweep/archive/checksum.hpp"

namespace trebsweep {

/// The optimum of a scene, as the archive of a study stores it; NaN without one.
struct SceneOptimum {
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  double value = nan;                   ///< the objective, in the unit of its field
  double speed = nan;                   ///< m/s
  double r1 = nan, r3 = nan, r2 = nan;  ///< m
  double release_time = nan;            ///< s
  double error = nan;                   ///< of the value, in its unit

  bool exists() const { return !std::isnan(value); }
};

/// The datasets of the members of SceneOptimum, in their order.
inline constexpr std::array<std::string_view, 7> scene_optimum_names{
    "best_value", "best_speed", "best_r1", "best_r3", "best_r2", "best_release_time", "best_error"};
static_assert(sizeof(SceneOptimum) == scene_optimum_names.size() * sizeof(double));

/// The checksum of its members' bytes.
inline std::uint64_t checksum(const SceneOptimum& optimum) {
  return checksum(std::as_bytes(std::span(&optimum, 1)));
}

/// The number of the scene with the largest value; nothing if no scene has an optimum.
std::optional<std::uint64_t> best_scene(std::span<const SceneOptimum> optima);

/// The optima of a study's scenes in its archive. Throws std::runtime_error unless the datasets
/// have the given extents, those of the outer axes.
std::vector<SceneOptimum> read_optima(hid_t file, const std::vector<hsize_t>& extents);

}  // namespace trebsweep
