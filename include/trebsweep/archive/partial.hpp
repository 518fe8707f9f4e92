#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

// The folder of an unfinished sweep, which journal.hpp describes.

/// What sweep.json says of it.
struct PartialSweep {
  std::string job;                   ///< text of the job file
  std::string source;                ///< program and version that started it
  std::string kernel;                ///< its instruction set
  int numerics = 0;                  ///< numerics_version
  Index3 tile_edge{};                ///< largest extent of a tile, cells
  std::string replaces;              ///< file_identity() of the archive that it replaces, or empty
  std::vector<std::string> history;  ///< a line for each run
};

/// Writes sweep.json, and creates the folder if it does not exist. For one rank.
void write_partial_sweep(const std::filesystem::path& folder, const PartialSweep& sweep);

/// Reads sweep.json. Throws std::runtime_error if it is missing or damaged.
PartialSweep read_partial_sweep(const std::filesystem::path& folder);

/// The journal of a rank in the run whose line of the history has the given number.
std::filesystem::path journal_path(const std::filesystem::path& folder, std::size_t run, int rank);

/// The journals in a folder, sorted.
std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder);

/// The archive while it is written.
std::filesystem::path unfinished_archive(const std::filesystem::path& folder);

/// Whether a folder is empty or holds only what a sweep creates.
bool is_partial_folder(const std::filesystem::path& folder);

/// Removes the folder of a sweep.
void remove_partial(const std::filesystem::path& folder);

/// Throws mpi::RootError if a rank cannot see a file, as when ranks run in different directories or
/// on file systems that they do not share. Collective.
void require_visible(const std::filesystem::path& path, MPI_Comm comm);

/// Renames a complete file to its final name, after an fsync. Throws std::runtime_error if that
/// name belongs to any file except the one whose file_identity() is `replaces`. For one rank.
void rename_to_final(const std::filesystem::path& from, const std::filesystem::path& to,
                     const std::string& replaces);

}  // namespace trebsweep
