#pragma once

#include <filesystem>
#include <string>

namespace trebsweep {

/// A description of an archive for human readers: for a sweep its progress, summary, provenance and
/// job, for an assessment its tables, provenance and job. If the file does not exist, its partial
/// archive is described. Needs no MPI. Throws InputError if there is no regular file, and
/// std::runtime_error if the file is damaged or not an archive of this format.
std::string describe_archive(const std::filesystem::path& path);

}  // namespace trebsweep
