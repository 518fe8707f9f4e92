#pragma once

#include <hdf5.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
//   tile_checksum         the checksum of its values in each map; missing without maps
//
// Its root attributes describe the sweep and its result. The maps, which several ranks write, have
// the checksums of tiles; HDF5 keeps one of every other dataset.

namespace trebsweep {

/// The version of this layout, stored in the attribute format_version.
inline constexpr std::uint64_t format_version = 1;

/// The name of a field's map, or of the outer axis of a key without its section.
std::string dataset_name(std::string_view name);
std::string dataset_name(Field field);

/// The value of a map in cells outside the lattice: 0 for flags, else NaN.
double fill_value(Field field);

/// The HDF5 type of a map's values in the file.
hid_t file_type(Field field, Storage storage);

/// The size of a tile's values in all maps, bytes.
std::uint64_t bytes_in(const Block& block, const Output& output);

/// The columns of tile_block.
inline constexpr std::array<std::string_view, 7> block_columns{
    "scene", "first_r1", "first_r3", "first_r2", "count_r1", "count_r3", "count_r2"};

/// Extents along the outer axes, r1, r3 and r2.
std::vector<hsize_t> map_extents(const Study& study);

/// The position in maps of the given extents of a tile's first cell, and the tile's extents.
struct MapBlock {
  std::vector<hsize_t> first, count;
};
MapBlock map_block(const Tile& tile, std::span<const hsize_t> map_extents);

/// The line that a run starting now adds to the attribute history.
std::string history_line(const std::string& command, int ranks);

}  // namespace trebsweep
