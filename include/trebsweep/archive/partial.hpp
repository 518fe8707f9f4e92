#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trebsweep/archive/run_id.hpp"
#include "trebsweep/archive/skeleton.hpp"

namespace trebsweep {

/// What an archive's history says of a run that begins now.
std::string history_line(const std::string& command, std::uint64_t ranks);

/// The name of an archive that is not complete.
std::filesystem::path partial_path(const std::filesystem::path& path);

/// The name of a file that is being created, and will be the partial one or the archive.
std::filesystem::path new_path(const std::filesystem::path& path);

/// Creates the partial file, in which every cell has its map's fill value; no other file has its
/// name at any time. A file under the partial file's name is replaced. Collective; the skeleton's
/// attributes are rank 0's. Returns, the same on all ranks, the mark of this run, or nothing where
/// a rank was stopped. Throws mpi::RootError, as where there is no space for it. Leaves nothing
/// where it returns none or throws.
std::optional<RunId> create_partial(const std::filesystem::path& path, const Skeleton& skeleton,
                                    const Watch& watch, MPI_Comm comm);

/// Makes a partial file ready for another run, of which its history gets a line: the tiles from
/// number `done` on are to be computed. For one rank alone. Throws std::runtime_error.
RunId continue_partial(const std::filesystem::path& path, const Tiling& tiling,
                       const std::vector<MapInfo>& maps, std::uint64_t done,
                       const std::string& history_line);

/// Throws mpi::RootError where a rank does not see a file, as where ranks work in different folders
/// or on file systems that they do not share. Collective.
void require_visible(const std::filesystem::path& path, MPI_Comm comm);

/// Gives the complete partial file, which must still have the run's mark, its own name. `replaces`
/// is the file_identity() of the archive that has the name and is to be replaced, if any; no other
/// file is. For one rank alone. Throws std::runtime_error.
void finish(const std::filesystem::path& path, const RunId& mark, const std::string& replaces);

/// Renames a new file, unless the name belongs to a file other than the one with the
/// file_identity() `replaces`. Throws std::runtime_error.
void rename_new(const std::filesystem::path& from, const std::filesystem::path& to,
                const std::string& replaces);

/// Runs f, which writes in the partial file; a failure says what it means.
void write_in(const std::filesystem::path& partial, const std::function<void()>& f);

}  // namespace trebsweep
