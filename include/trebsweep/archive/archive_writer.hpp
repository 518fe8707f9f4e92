#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/journal.hpp"
#include "trebsweep/archive/skeleton.hpp"

namespace trebsweep {

/// The results of a tile as the bytes of a record: its tally, and `maps`, its values in each map of
/// a job, r2 fastest, as the archive stores them.
std::vector<std::byte> to_bytes(const Tally& tally, std::vector<std::vector<double>> maps,
                                const Output& output);

/// The number of those bytes.
std::uint64_t result_bytes(const Block& block, const Output& output);

/// The tally in the record of a tile.
Tally tally_of(const Record& tile);

/// Writes an archive without attributes in one process, without MPI: the given tiles; cells of
/// others keep the fill values of their maps. Throws std::runtime_error.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const Record> tiles);

/// Writes an archive without attributes, each rank the given tiles of its own. The rest is taken
/// from rank 0, but the optima must be the same on all ranks. Throws mpi::RootError if rank 0
/// cannot create it, and std::runtime_error on a rank that cannot write its tiles. Collective.
void write_archive(const std::filesystem::path& path, const Skeleton& skeleton,
                   std::span<const Record> own, MPI_Comm comm);

/// Sizes, bytes.
struct NeededSpace {
  std::uintmax_t archive;   ///< 0 if it is compressed, and its size unknown
  std::uintmax_t journals;  ///< of all ranks
};

/// The space that a sweep needs, a percent too low at most.
NeededSpace needed_space(const Study& study, const Tiling& tiling);

}  // namespace trebsweep
