#pragma once

#include <filesystem>
#include <string>

namespace trebsweep {

/// What an archive holds, as text for people: of a sweep, its progress, summary, provenance and
/// job; of an assessment, its tables and job. Where there is no such file but an unfinished one
/// that will have its name, that of it. Needs no MPI. Throws InputError where there is no file, or
/// no regular one, and std::runtime_error where it is no archive of this format, or a damaged one.
std::string describe_archive(const std::filesystem::path& path);

}  // namespace trebsweep
