#pragma once

#include <filesystem>
#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

// The files of an archive: <path> once complete, and next to it the folder <path>.partial while a
// sweep is unfinished, <path>.new while an assessment is written, and <path>.lock while a run is
// active.

std::filesystem::path partial_path(const std::filesystem::path& path);
std::filesystem::path new_path(const std::filesystem::path& path);
std::filesystem::path lock_path(const std::filesystem::path& path);

/// Throws an InputError that names output.file and its value.
[[noreturn]] void refuse_output(const Job& job, const std::string& why);

/// The job's output file with symbolic links resolved. Throws InputError if it, or what is next
/// to it, cannot have its name or exists and is of another kind.
std::filesystem::path checked_output_path(const Job& job);

}  // namespace trebsweep
