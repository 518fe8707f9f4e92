#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace trebsweep {

/// Keeps others who ask for the same lock file out, on all hosts that share its file system. The
/// lock dies with its process; its file, which names the holder, goes at the end of the scope, and
/// stays if there is none. An empty file serves as a lock too, and stays empty: it may be
/// somebody's own, or of a run that was killed before it wrote its name.
class FileLock {
 public:
  /// Throws InputError, naming the holder, where another process has the lock, and where there is a
  /// file that is no lock, which it leaves alone; std::system_error where the file cannot be
  /// written. Where locks do not work, a message on stderr tells it, and every process gets the
  /// lock.
  explicit FileLock(const std::filesystem::path& path);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

  /// Whether the file was left by a process of this program that was killed.
  bool was_left() const { return was_left_; }

 private:
  std::filesystem::path path_;
  int file_ = -1;
  bool own_ = false;  ///< the file has our text, and goes with us
  bool was_left_ = false;
};

/// Who has the lock, if another process has it.
std::optional<std::string> lock_holder(const std::filesystem::path& path);

}  // namespace trebsweep
