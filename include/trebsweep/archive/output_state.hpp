#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/archive/partial.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// What a run finds at the path of its archive.
struct OutputState {
  std::filesystem::path path;  ///< of the archive: output.file with symbolic links resolved
  bool complete = false;       ///< the complete archive of this job exists
  std::string replaces;        ///< file_identity() of the archive that the run will replace, if any
  std::optional<PartialSweep> partial;  ///< the unfinished sweep of this job, to be resumed
  std::unique_ptr<FileLock> lock;       ///< held until the archive is finished; none if complete
};

/// Inspects and locks the path of a sweep's archive, and changes nothing else,
/// except that it removes what is left of a sweep whose archive is complete. For one rank.
/// `overwrite` permits replacing an archive or an unfinished sweep, but nothing else. Throws
/// InputError if the path cannot be written, is in use by another process, or if it or a file next
/// to it (.lock, .partial) holds something else; throws std::runtime_error if the unfinished sweep
/// of this job cannot be resumed.
OutputState open_or_resume(const Job& job, bool overwrite);

/// Inspects and locks the path of an assessment. For one rank. Throws InputError as
/// open_or_resume() does, and if an unfinished sweep exists.
OutputState reserve_output(const Job& job, bool overwrite);

}  // namespace trebsweep
