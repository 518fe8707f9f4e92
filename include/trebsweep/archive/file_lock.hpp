#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// An exclusive advisory lock (fcntl) on a folder, effective on all hosts that share the file
/// system. It creates the folder if it does not exist, and in it the file "lock", which names the
/// process. The system releases the lock when the process ends. The destructor removes the file,
/// and the folder if it is then empty; a killed process leaves both behind.
class FileLock {
 public:
  /// Throws InputError if another process holds the lock, naming it, and std::system_error if the
  /// file cannot be written. On a file system without locking, prints a message to stderr and
  /// grants the lock to every process.
  explicit FileLock(const std::filesystem::path& folder);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path folder_;
  int file_ = -1;
};

/// The name of the file in the folder.
inline constexpr const char* lock_name = "lock";

/// Throws InputError as FileLock() does if another process holds the lock, and std::system_error if
/// the file could not be written, without writing it.
void require_lockable(const std::filesystem::path& folder);

/// The process that holds the lock on a folder, if another process does.
std::optional<std::string> lock_holder(const std::filesystem::path& folder);

}  // namespace trebsweep
