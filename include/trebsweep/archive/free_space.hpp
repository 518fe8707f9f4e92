#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace trebsweep {

/// Throws std::runtime_error if a file of the given size, in bytes, cannot be created at a path
/// where no file exists, because of the space on the disk, a quota, or the process's file size
/// limit (ulimit -f). Leaves no file behind.
void require_space(const std::filesystem::path& path, std::uintmax_t bytes);

/// The limit that keeps a file from growing, worded as the end of a message; empty if unknown.
std::string reached_limit(const std::filesystem::path& path);

}  // namespace trebsweep
