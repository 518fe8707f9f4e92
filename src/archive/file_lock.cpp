#include "trebsweep/archive/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/message.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view signature = "trebsweep lock: ";

/// Opens a file; returns -1 if it does not exist. Neither follows links nor waits for the other end
/// of a FIFO.
int open_existing(const fs::path& path, int mode) {
  const int file = open(path.c_str(), mode | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0 && errno != ENOENT) throw std::system_error(errno, std::generic_category());
  return file;
}

/// Creates a file; returns -1 if it exists.
int create(const fs::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0 && errno != EEXIST) throw std::system_error(errno, std::generic_category());
  return file;
}

bool is_regular(int file) {
  struct stat status {};
  return fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

std::string read_text(int file) {
  std::array<char, 300> text{};
  const auto length = is_regular(file) ? pread(file, text.data(), text.size(), 0) : -1;
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : "";
}

/// Whether a file may be locked: it is empty or was written by write_holder().
bool is_lock(int file) {
  struct stat status {};
  return is_regular(file) && fstat(file, &status) == 0 &&
         (status.st_size == 0 || read_text(file).starts_with(signature));
}

/// The process that a lock file names.
std::string holder(int file) {
  const std::string text = read_text(file);
  return text.starts_with(signature) ? text.substr(signature.size()) : "another process";
}

/// The lock request for fcntl, which unlike flock() also works on network file systems.
struct flock exclusive_lock() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

enum class LockResult { acquired, held, unsupported };

/// Tries to lock a file: `held` if another process holds the lock, `unsupported`, with the cause in
/// errno, if the file system has no locking.
LockResult try_lock(int file) {
  struct flock lock = exclusive_lock();
  if (fcntl(file, F_SETLK, &lock) == 0) return LockResult::acquired;
  if (errno == EACCES || errno == EAGAIN) return LockResult::held;
  if (errno == ENOLCK || errno == ENOSYS || errno == EOPNOTSUPP || errno == EINVAL)
    return LockResult::unsupported;
  throw std::system_error(errno, std::generic_category());
}

/// Whether the path still names the open file: its former holder may just have removed it.
bool has_path(int file, const fs::path& path) {
  struct stat opened {
  }, named{};
  return fstat(file, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Writes the name of this process over that of a former holder.
void write_holder(int file) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("{}process {} on {}", signature, getpid(), host.data());
  const auto size = static_cast<off_t>(text.size());
  // A failure, such as a full disk, is ignored: the text only informs the user.
  if (pwrite(file, text.data(), text.size(), 0) == size) static_cast<void>(!ftruncate(file, size));
}

}  // namespace

FileLock::FileLock(const fs::path& path) : path_(path) {
  // The destructor does not run if the constructor throws.
  const auto refuse = [&](const std::string& why) {
    close(file_);
    throw InputError(why);
  };
  for (;;) {
    file_ = open_existing(path, O_RDWR);
    const bool created = file_ < 0;
    if (created) file_ = create(path);
    if (file_ < 0) continue;  // another process has just created it
    if (!is_lock(file_))
      refuse(fmt::format(
          "{} exists and is not a lock file of this program; move it away, or name another "
          "file",
          path.string()));
    const std::string former = holder(file_);
    was_stale_ = !created && !read_text(file_).empty();
    owns_file_ = created || was_stale_;
    const LockResult result = try_lock(file_);
    if (result == LockResult::held)
      refuse(fmt::format("another run is writing it: {} is held by {}", path.string(), former));
    if (result == LockResult::unsupported)
      print_message(fmt::format(
          "trebsweep: {}: file locking does not work here ({}); make sure that no other run writes "
          "the same archive\n",
          path.string(), std::strerror(errno)));
    if (has_path(file_, path)) break;
    close(file_);
  }
  if (owns_file_) write_holder(file_);
}

FileLock::~FileLock() {
  if (owns_file_) unlink(path_.c_str());  // while it is locked, so that no other process holds it
  close(file_);
}

std::optional<std::string> lock_holder(const fs::path& path) {
  try {
    const int file = open_existing(path, O_RDONLY);
    if (file < 0) return std::nullopt;
    struct flock lock = exclusive_lock();
    const bool held = is_lock(file) && fcntl(file, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
    const std::string who = holder(file);
    close(file);
    return held ? std::optional(who) : std::nullopt;
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

}  // namespace trebsweep
