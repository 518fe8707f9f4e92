#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Where an archive goes, and what a sweep finds there.
struct OutputState {
  std::filesystem::path path;  ///< of the archive: output.file, links followed
  bool complete = false;       ///< the archive of this very job is there
  std::string replaces;        ///< file_identity() of the archive that will be replaced, if any
  std::optional<ArchiveContents> begun;  ///< an unfinished sweep of this very job, to be continued
  std::unique_ptr<FileLock> lock;  ///< to be kept until the archive is finished; none if complete
};

/// Looks at the place of the job's archive and locks it. Changes nothing else. For one rank alone.
/// `overwrite` allows to replace an archive, or an unfinished one, and no other file. Throws
/// InputError where the place cannot be written, is being written by another process, or holds
/// something else, under its name or those of the files next to it (.lock, .partial, .partial.new);
/// and std::runtime_error where an unfinished sweep cannot be continued.
OutputState open_or_resume(const Job& job, bool overwrite);

/// Locks the place of an assessment. For one rank alone. Throws InputError where prepare_output()
/// does, and where there is an unfinished sweep.
OutputState reserve_output(const Job& job, bool overwrite);

}  // namespace trebsweep
