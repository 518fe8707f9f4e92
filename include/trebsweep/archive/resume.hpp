#pragma once

#include <filesystem>

#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/archive_header.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Whether an archive is a sweep whose job produces the same maps in the same format as `job`.
bool is_same_job(const Job& job, const ArchiveHeader& archive);

/// Reads the partial archive that `job` is to resume. Throws InputError if it belongs to another
/// job, and std::runtime_error if it is damaged, or was started by another version or with another
/// kind of floating-point arithmetic: its maps would differ from those of an uninterrupted sweep.
ArchiveContents read_resumable(const Job& job, const std::filesystem::path& partial);

}  // namespace trebsweep
