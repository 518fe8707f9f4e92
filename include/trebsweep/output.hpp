#pragma once

#include <memory>
#include <optional>

#include "trebsweep/contents.hpp"
#include "trebsweep/file_lock.hpp"
#include "trebsweep/job.hpp"

namespace trebsweep {

/// What a sweep finds at the place of its archive.
struct Place {
  bool complete = false;           ///< the archive of this very job is there
  std::optional<Contents> begun;   ///< an unfinished sweep of this very job, to be continued
  std::unique_ptr<FileLock> lock;  ///< to be kept until the archive is finished; none if complete
};

/// Looks at the place of the job's archive and locks it. Changes nothing else. For one rank alone.
/// `overwrite` allows to replace an archive, or an unfinished one, but no other file. Throws
/// InputError where the place cannot be written, is being written by another process, or holds
/// something else, and std::runtime_error where an unfinished sweep cannot be continued.
Place prepare_output(const Job& job, bool overwrite);

/// Locks the place of what is no sweep, as long as the lock is kept. For one rank alone. Throws
/// InputError where prepare_output() does, and where an unfinished sweep is to go there.
std::unique_ptr<FileLock> reserve_output(const Job& job, bool overwrite);

}  // namespace trebsweep
