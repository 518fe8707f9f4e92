#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Checks that a file of the given size, in bytes, can be created at a path where no file exists,
/// for the archive of a job. Throws InputError if the disk has less free space, and
/// std::runtime_error if a quota or the process's file size limit (ulimit -f) forbids it. Leaves no
/// file behind.
void require_space(const Job& job, const std::filesystem::path& path, std::uintmax_t bytes);

/// The limit that keeps a file from growing, worded as the end of a message; empty if unknown.
std::string reached_limit(const std::filesystem::path& path);

}  // namespace trebsweep
