#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/base/progress.hpp"
#include "trebsweep/job/tiling.hpp"

namespace trebsweep {

/// Those of an archive's first `done` tiles that do not match their checksums, in ascending order.
/// The ranks share the tiles; collective, with the same result on all ranks. If `stop` is true on a
/// rank, that rank leaves the rest of its tiles unverified. Throws mpi::RootError if the file
/// cannot be read.
std::vector<TileRange> damaged_tiles(const std::filesystem::path& path,
                                     const std::vector<MapInfo>& maps, const Study& study,
                                     const Tiling& tiling, std::uint64_t done, Progress& progress,
                                     const std::function<bool()>& stop, MPI_Comm comm);

/// The numbers of tiles, such as "3, 7 to 9"; at most 20 ranges.
std::string to_text(const std::vector<TileRange>& tiles);

}  // namespace trebsweep
