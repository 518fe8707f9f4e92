#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace trebsweep {

/// A quantity that a sweep can map over the lattice.
enum class Field { speed, release_time, status };

/// How a field is called and described.
struct FieldInfo {
  std::string_view name;     ///< in job files; datasets have `_` for `-`
  std::string_view units;    ///< UDUNITS; empty for flags
  std::string_view meaning;  ///< CF long_name
};

/// In the order of Field.
inline constexpr std::array<FieldInfo, 3> field_info{{
    {"speed", "m s-1", "speed of the projectile at release"},
    {"release-time", "s", "time from the start to the release"},
    {"status", "", "what became of the design"},
}};

inline constexpr const FieldInfo& info(Field field) {
  return field_info[static_cast<std::size_t>(field)];
}

}  // namespace trebsweep
