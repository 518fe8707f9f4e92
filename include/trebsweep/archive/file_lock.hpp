#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// An exclusive advisory lock (fcntl) on a file that names its holder, effective on all hosts that
/// share the file system. The system releases the lock when the process ends; the destructor
/// removes the file, and a killed process leaves it behind. An existing empty file can be locked
/// too, but is neither written nor removed: it may belong to the user, or be that of a run that was
/// killed before it wrote its name.
class FileLock {
 public:
  /// Throws InputError if another process holds the lock, naming it, or if the file exists and is
  /// not a lock file; throws std::system_error if the file cannot be written. On a file system
  /// without locking, prints a message to stderr and grants the lock to every process.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Whether the file was left behind by a killed process of this program.
  bool was_stale() const { return was_stale_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  bool owns_file_ = false;  ///< the file names this process, and is removed with the lock
  bool was_stale_ = false;
};

/// The process that holds the lock, if another process does.
std::optional<std::string> lock_holder(const std::filesystem::path& path);

}  // namespace trebsweep
