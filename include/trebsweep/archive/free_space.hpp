#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// Checks that a file of the given size, in bytes, can be created at a path, for the archive of a
/// job, and that the disk has room for `all` bytes. Throws InputError if it has not, or if the
/// process's file size limit (ulimit -f) forbids it.
void require_space(const Job& job, const std::filesystem::path& path, std::uintmax_t bytes,
                   std::uintmax_t all);

/// The limit that keeps a file from growing, worded as the end of a message; empty if unknown.
std::string reached_limit(const std::filesystem::path& path);

}  // namespace trebsweep
