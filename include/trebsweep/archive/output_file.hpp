#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The folder next to an archive, which exists until the archive is complete.
std::filesystem::path partial_path(const std::filesystem::path& path);

/// Throws an InputError that names output.file and its value.
[[noreturn]] void refuse_output(const Job& job, const std::string& why);

/// What exists at the path of an archive, reserved for this run.
struct OutputFile {
  std::filesystem::path path;           ///< with symbolic links resolved
  bool complete = false;                ///< the archive of this job
  std::optional<PartialSweep> partial;  ///< of this job, to be continued
  std::string replaces;                 ///< file_identity() of what is replaced, or empty
  std::unique_ptr<FileLock> lock;       ///< of the folder; none if the archive is complete
};

/// Whether a path is reserved, or only inspected and left as it is.
enum class Reserve { yes, no };

/// Inspects and locks the path of a sweep's archive. For one rank. `overwrite` permits replacing an
/// archive or an unfinished sweep, but nothing else. Removes what is left of a sweep whose archive
/// is complete. Throws InputError if the path cannot be written, is in use by another process, or
/// if it or the folder next to it holds something else; throws std::runtime_error if the unfinished
/// sweep of this job cannot be continued.
OutputFile open_or_resume(const Job& job, bool overwrite, Reserve reserve = Reserve::yes);

/// Inspects and locks the path of an assessment. For one rank. Throws InputError as
/// open_or_resume() does, and if an unfinished sweep exists.
OutputFile reserve_output(const Job& job, bool overwrite, Reserve reserve = Reserve::yes);

/// Gives the archive in the folder its final name, after an fsync, and clears the folder. Throws
/// std::runtime_error if that name belongs to a file that was not there when it was reserved. For
/// one rank.
void finish_output(const OutputFile& output);

}  // namespace trebsweep
