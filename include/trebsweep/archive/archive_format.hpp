#pragma once

#include <hdf5.h>

#include <array>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "trebsweep/job/lattice.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// The version of the form of archives: format_version.
inline constexpr unsigned long long archive_format = 3;

/// Number types that a map can have in the file.
enum class MapType { float64, float32, uint8 };

/// How a map is stored and described.
struct MapInfo {
  std::string dataset;
  std::string units;  ///< UDUNITS; empty for none
  std::string long_name;
  std::string ancillary;  ///< CF ancillary_variables; empty for none
  MapType type;
  double fill;                             ///< the value of cells outside the lattice
  std::vector<std::string> flag_meanings;  ///< CF flags, of values 0, 1, ...; empty for numbers
};

/// Root attributes, by name.
using Attributes =
    std::vector<std::pair<std::string, std::variant<std::string, double, unsigned long long>>>;

/// The name of a field's map.
std::string dataset_name(Field field);

void write_attributes(hid_t file, const Attributes& attributes);

/// The HDF5 type of a map's numbers in the file.
hid_t file_type(MapType type);

inline std::array<hsize_t, 3> sizes(const Index3& index) { return {index[0], index[1], index[2]}; }

}  // namespace trebsweep
