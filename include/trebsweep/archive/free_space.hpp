#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace trebsweep {

/// Throws std::runtime_error where no file of that size, in bytes, can be made under a path that is
/// free: for want of space on its disk, by a quota, or by the process's limit of file size (ulimit
/// -f). Leaves no file there.
void require_space(const std::filesystem::path& path, std::uintmax_t bytes);

/// What keeps a file from growing, as the end of a message; empty if that cannot be told.
std::string obstacle(const std::filesystem::path& path);

}  // namespace trebsweep
