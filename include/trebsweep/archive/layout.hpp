#pragma once

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/tiling.hpp"

// What an archive holds
//
//   r1, r3, r2            axes: the values of all scenes, m
//   fulcrum_height, ...   outer axes, of a study: the values of its keys
//   speed, ...            maps (outer axes, r1, r3, r2), in chunks of a tile
//   best_value, ...       of a study, the optima of its scenes (outer axes): best_names
//   scene_lattice         the number of each scene's lattice (outer axes)
//   lattice_r1            whether a value of r1 belongs to it (lattice, r1)
//   lattice_rows          how many designs it has along r2, the first ones (lattice, r3)
//   tile_block            the scene of each tile, and its first cell and extent along r1, r3, r2
//   tile_designs          its designs with each Status; all 0 if the tile is not done
//   tile_checksum         checksums: checksum_columns()
//
// Its root attributes describe the sweep and its result: root_attributes().

namespace trebsweep {

/// The version of this layout, stored in the attribute format_version.
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

/// How the job's maps are stored and described, in the order of its fields.
std::vector<MapInfo> map_infos(const Output& output);

/// The value of a map in cells outside the lattice: 0 for flags, else NaN.
double fill_value(Field field);

/// The name of a field's map, or of the outer axis of a key without its section.
std::string dataset_name(std::string_view name);

/// The HDF5 type of a map's values in the file.
hid_t file_type(MapType type);

/// The size of a tile's values in all maps, bytes.
std::uint64_t bytes_in(const Block& block, std::span<const MapInfo> maps);

/// The columns of tile_block.
inline constexpr std::array<std::string_view, 7> block_columns{
    "scene", "first_r1", "first_r3", "first_r2", "count_r1", "count_r3", "count_r2"};

/// The columns of tile_checksum: the maps; of a study, best, which covers the optimum of a scene in
/// the scene's last tile and is 0 in its others; tile_designs.
std::vector<std::string> checksum_columns(std::span<const MapInfo> maps, bool is_study);

/// Whether a column of tile_checksum is that of a map.
bool is_map(std::string_view column);

/// Extents along the outer axes, r1, r3 and r2.
std::vector<hsize_t> map_extents(const Study& study);

/// The position in maps of the given extents of a tile's first cell, and the tile's extents.
struct MapBlock {
  std::vector<hsize_t> first, count;
};
MapBlock map_block(const Tile& tile, std::span<const hsize_t> map_extents);

/// Names and values of root attributes.
using Attributes =
    std::vector<std::pair<std::string, std::variant<std::string, double, unsigned long long>>>;

/// The root attributes of a sweep's archive. NaN stands for what does not exist or was not
/// measured.
Attributes root_attributes(const Job& job, const std::string& history, const Summary& summary);

void write_attributes(hid_t file, const Attributes& attributes);

/// The line that a run starting now adds to the attribute history.
std::string history_line(const std::string& command, std::uint64_t ranks);

}  // namespace trebsweep
