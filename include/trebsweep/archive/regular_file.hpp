#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// The kind of a file that is not regular, such as "a directory" or "a FIFO"; nothing if it is
/// regular or does not exist. Opening another kind of file may block or have side effects.
std::optional<std::string> irregular_kind(const std::filesystem::file_status& status);

/// The same for the file that a path names; follows symbolic links.
std::optional<std::string> irregular_kind(const std::filesystem::path& path);

/// The directory of a file: "." for a name alone.
std::filesystem::path directory_of(const std::filesystem::path& path);

/// A text that changes whenever a file is replaced or modified: its inode, size and time of
/// modification; empty if the file does not exist. Throws std::system_error.
std::string file_identity(const std::filesystem::path& path);

/// Waits until a file is on disk (fsync). Throws std::runtime_error.
void sync_file(const std::filesystem::path& path);

/// Resolves a path that may be a symbolic link, dangling or not. Throws std::system_error if the
/// links form a loop.
std::filesystem::path follow_links(std::filesystem::path path);

}  // namespace trebsweep
