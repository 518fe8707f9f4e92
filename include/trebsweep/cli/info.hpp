#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "trebsweep/base/progress.hpp"

namespace trebsweep {

/// A description of an archive, as text or a JSON object: for a sweep its progress, summary,
/// provenance and job, for an assessment its tables, provenance and job. If the file does not
/// exist, its partial sweep is described. Needs no MPI. Throws InputError if there is neither, and
/// std::runtime_error if it is damaged or not of this format.
std::string describe_archive(const std::filesystem::path& path, bool json = false);

/// Writes what is done of an unfinished sweep as an archive, to a new file. Throws as
/// describe_archive() does, and InputError if the file exists.
void write_snapshot(const std::filesystem::path& folder, const std::filesystem::path& output);

/// Compares every tile with its checksums, and prints a line for each damaged map of a tile, or one
/// line if all are as they were written. Needs no MPI. Throws as describe_archive() does, and
/// std::runtime_error if the archive is damaged or not complete.
void verify_archive(const std::filesystem::path& path, ProgressStyle style, std::FILE* out);

}  // namespace trebsweep
