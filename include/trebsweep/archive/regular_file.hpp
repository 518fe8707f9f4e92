#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// What there is instead of a regular file, in words such as "a folder" or "a FIFO"; nothing for a
/// regular file, and for none. Opening anything else may block, or have effects of its own.
std::optional<std::string> irregular_kind(const std::filesystem::file_status& status);

/// The same for what a path names, links followed.
std::optional<std::string> irregular_kind(const std::filesystem::path& path);

/// What tells a file from any that replaces it or changes it: its inode, size and time of change;
/// empty where there is no file. Throws std::system_error.
std::string file_identity(const std::filesystem::path& path);

/// Where a path leads that may be a symbolic link, dangling or not. Throws std::system_error where
/// links lead in a circle.
std::filesystem::path follow_links(std::filesystem::path path);

}  // namespace trebsweep
