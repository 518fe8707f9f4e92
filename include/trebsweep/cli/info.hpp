#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "trebsweep/base/progress.hpp"

namespace trebsweep {

/// A description of an archive for human readers: for a sweep its progress, summary, provenance and
/// job, for an assessment its tables, provenance and job. If the file does not exist, its partial
/// archive is described. Needs no MPI. Throws InputError if there is no regular file, and
/// std::runtime_error if the file is damaged or not an archive of this format.
std::string describe_archive(const std::filesystem::path& path);

/// Compares every tile that is done with its checksums, and prints a line for each damaged map of a
/// tile, or one line if all are as they were written. Needs no MPI. Throws as describe_archive()
/// does, and std::runtime_error if the archive is damaged, has no checksums or is being written.
void verify_archive(const std::filesystem::path& path, ProgressStyle style, std::FILE* out);

}  // namespace trebsweep
