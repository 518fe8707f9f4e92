#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/layout.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// What an archive holds except for the results of its tiles and its attributes.
struct Skeleton {
  const Study& study;
  const Tiling& tiling;
  std::span<const BestDesign> optima;  ///< of the scenes

  const Job& job() const { return study.job(); }
  std::vector<Field> maps() const { return stored_fields(job().output); }
};

/// The rows of tile_designs and tile_checksum, one after the other.
struct TileTable {
  std::vector<std::uint64_t> designs, checksums;
};

/// Creates the file, or replaces it, without attributes and the values of the maps, whose cells
/// have their fill values. For one rank. Throws std::runtime_error.
void create_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                     const TileTable& table);

/// Allocates the chunks that hold designs, so that several ranks can write them. For one rank.
/// Throws std::runtime_error.
void allocate_chunks(const std::filesystem::path& path, const Skeleton& skeleton);

/// Describes a sweep in the attributes of its archive; `history` has a line for each run. NaN
/// stands for what does not exist or was not measured. For one rank. Throws std::runtime_error.
void write_attributes(const std::filesystem::path& path, const Job& job,
                      const std::vector<std::string>& history, const Summary& summary);

}  // namespace trebsweep
