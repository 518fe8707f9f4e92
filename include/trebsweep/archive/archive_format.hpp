#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// The file format version, stored in the attribute format_version. It changes with the layout.
inline constexpr unsigned long long format_version = 1;

/// Number types of a map in the file.
enum class MapType { float64, float32, uint8 };

/// How a map is stored and described.
struct MapInfo {
  std::string dataset;
  std::string units;  ///< UDUNITS; empty if it has none
  std::string long_name;
  std::string ancillary;  ///< CF ancillary_variables; empty if it has none
  MapType type;
  double fill;                             ///< value of the cells outside the lattice
  std::vector<std::string> flag_meanings;  ///< CF flag_meanings of 0, 1, ...; empty for numbers
};

/// Names and values of root attributes.
using Attributes =
    std::vector<std::pair<std::string, std::variant<std::string, double, unsigned long long>>>;

/// The name of a field's map, or of the outer axis of a key without its section.
std::string dataset_name(std::string_view name);
inline std::string dataset_name(Field field) { return dataset_name(info(field).name); }

/// The line that a run starting now adds to the attribute history.
std::string history_line(const std::string& command, std::uint64_t ranks);

void write_attributes(hid_t file, const Attributes& attributes);

/// The columns of tile_checksum: the maps; of a study, best, which covers the optimum of a scene in
/// the scene's last tile and is 0 in its others; tile_tally.
std::vector<std::string> checksum_columns(const std::vector<MapInfo>& maps, bool is_study);

/// The HDF5 type of a map's values in the file.
hid_t file_type(MapType type);

}  // namespace trebsweep
