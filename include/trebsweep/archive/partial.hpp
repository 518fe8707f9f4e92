#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"
#include "trebsweep/job/lattice.hpp"

namespace trebsweep {

// The folder of an unfinished archive, which journal.hpp describes.

/// What sweep.json says of an unfinished sweep.
struct PartialSweep {
  std::string job;                   ///< text of the job file
  std::string source;                ///< program and version that started it
  std::string kernel;                ///< its instruction set
  int numerics = 0;                  ///< numerics_version
  Index3 tile_edge{};                ///< largest extent of a tile, cells
  std::string replaces;              ///< file_identity() of the archive that it replaces, or empty
  std::vector<std::string> history;  ///< a line for each run
};

/// Writes sweep.json in an existing folder. For one rank.
void write_partial_sweep(const std::filesystem::path& folder, const PartialSweep& sweep);

/// Reads sweep.json. Throws std::runtime_error if it is missing or damaged.
PartialSweep read_partial_sweep(const std::filesystem::path& folder);

/// Throws InputError if an unfinished sweep belongs to another job, and std::runtime_error if it
/// was started with another version of the numerics or another kind of floating-point arithmetic:
/// its maps would differ from those of an uninterrupted sweep.
void require_resumable(const Job& job, const std::filesystem::path& folder,
                       const PartialSweep& partial);

/// Whether the text of a job file that a sweep stored is that of a job with the same results.
bool is_same_job(const Job& job, const std::string& stored);

/// The journal of a rank in the run whose line of the history has the given number.
std::filesystem::path journal_path(const std::filesystem::path& folder, std::size_t run, int rank);

/// The journals in a folder, sorted.
std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder);

/// The archive while it is written.
std::filesystem::path unfinished_archive(const std::filesystem::path& folder);

/// Whether a folder holds only what this program creates in it.
bool is_partial_folder(const std::filesystem::path& folder);

/// Removes everything from a folder except its lock. Throws std::filesystem::filesystem_error.
void clear_partial(const std::filesystem::path& folder);

}  // namespace trebsweep
