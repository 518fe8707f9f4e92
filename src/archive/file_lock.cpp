#include "trebsweep/archive/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/message.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The lock request for fcntl, which unlike flock() also works on network file systems.
struct flock exclusive_lock() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// The process that a lock file names.
std::string holder(int file) {
  std::array<char, 300> text{};
  const auto length = pread(file, text.data(), text.size(), 0);
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length))
                    : "another process";
}

/// Writes the name of this process over that of a former holder.
void write_holder(int file) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("process {} on {}", getpid(), host.data());
  const auto size = static_cast<off_t>(text.size());
  // A failure, such as a full disk, is ignored: the text only informs the user.
  if (pwrite(file, text.data(), text.size(), 0) == size) static_cast<void>(!ftruncate(file, size));
}

[[noreturn]] void refuse_held(const fs::path& path, const std::string& who) {
  throw InputError(fmt::format("another run is writing it: {} is held by {}", path.string(), who));
}

/// Whether the path still names the open file: its former holder may just have removed it.
bool has_path(int file, const fs::path& path) {
  struct stat opened, named;
  return fstat(file, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Locks a file. Returns false if another process holds the lock.
bool try_lock(int file, const fs::path& path) {
  struct flock lock = exclusive_lock();
  if (fcntl(file, F_SETLK, &lock) == 0) return true;
  if (errno == EACCES || errno == EAGAIN) return false;
  if (errno != ENOLCK && errno != ENOSYS && errno != EOPNOTSUPP && errno != EINVAL)
    throw std::system_error(errno, std::generic_category(), path.string());
  print_message(
      fmt::format("trebsweep: {}: file locking does not work here ({}); make sure that no other "
                  "run writes the same archive\n",
                  path.string(), std::strerror(errno)));
  return true;
}

}  // namespace

FileLock::FileLock(const fs::path& folder) : folder_(folder) {
  const fs::path path = folder / lock_name;
  // Its former holder may remove the file and the folder at any time.
  for (bool locked = false; !locked;) {
    const bool is_there = mkdir(folder.c_str(), 0777) == 0 || errno == EEXIST;
    file_ = is_there ? open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666) : -1;
    if (is_there && file_ < 0 && errno == ENOENT) continue;
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), path.string());
    if (!try_lock(file_, path)) {
      const std::string other = holder(file_);
      close(file_);  // the destructor does not run
      refuse_held(path, other);
    }
    locked = has_path(file_, path);
    if (!locked) close(file_);
  }
  write_holder(file_);
}

FileLock::~FileLock() {
  std::error_code ignored;
  fs::remove(folder_ / lock_name, ignored);  // while locked, so that no other process holds it
  close(file_);
  fs::remove(folder_, ignored);
}

void require_lockable(const fs::path& folder) {
  if (const auto who = lock_holder(folder)) refuse_held(folder / lock_name, *who);
  const fs::path written = fs::exists(folder) ? folder : directory_of(folder);
  if (access(written.c_str(), W_OK | X_OK) != 0)
    throw std::system_error(errno, std::generic_category(), written.string());
}

std::optional<std::string> lock_holder(const fs::path& folder) {
  const fs::path path = folder / lock_name;
  const int file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  struct flock lock = exclusive_lock();
  const bool held = fcntl(file, F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
  const std::string who = holder(file);
  close(file);
  return held ? std::optional(who) : std::nullopt;
}

}  // namespace trebsweep
