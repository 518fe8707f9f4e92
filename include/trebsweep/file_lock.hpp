#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// Keeps others who ask for the same lock file out, on all hosts that share its file system. The
/// lock dies with its process; its file goes at the end of the scope, and stays if there is none.
class FileLock {
 public:
  /// Throws InputError, naming the holder, where somebody else has the lock, and
  /// std::system_error where the file cannot be written. On a file system without locks everybody
  /// gets it.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path path_;
  int file_;
};

/// Who has the lock, if another process has; its own is not told.
std::optional<std::string> lock_holder(const std::filesystem::path& path);

}  // namespace trebsweep
