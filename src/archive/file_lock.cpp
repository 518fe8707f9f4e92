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

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view signature = "trebsweep lock: ";

/// A file descriptor, or -1 where there is no such file. Neither follows links nor waits for the
/// other end of a FIFO.
int open_if_there(const fs::path& path, int mode) {
  const int file = open(path.c_str(), mode | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (file < 0 && errno != ENOENT) throw std::system_error(errno, std::generic_category());
  return file;
}

/// The same for a file that was not there; -1 where it is now.
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

/// Whether a file may be locked: an empty one, or one with a lock's text.
bool is_lock(int file) {
  struct stat status {};
  return is_regular(file) && fstat(file, &status) == 0 &&
         (status.st_size == 0 || read_text(file).starts_with(signature));
}

/// The holder that a lock file names.
std::string holder(int file) {
  const std::string text = read_text(file);
  return text.starts_with(signature) ? text.substr(signature.size()) : "another process";
}

// By fcntl, which also network file systems have.
struct flock whole_file() {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return whole;
}

enum class Taken { yes, no, unknown };

/// Takes the lock, unless another process has it. What the answer is where locks do not work is
/// unknown, and why is in errno.
Taken take(int file) {
  struct flock whole = whole_file();
  if (fcntl(file, F_SETLK, &whole) == 0) return Taken::yes;
  if (errno == EACCES || errno == EAGAIN) return Taken::no;
  if (errno == ENOLCK || errno == ENOSYS || errno == EOPNOTSUPP || errno == EINVAL)
    return Taken::unknown;
  throw std::system_error(errno, std::generic_category());
}

/// Whether the file still has its name: a former holder may just have removed it.
bool is_named(int file, const fs::path& path) {
  struct stat opened {
  }, named{};
  return fstat(file, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

/// Writes who has the lock, over the text of a former holder.
void write_holder(int file) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("{}process {} on {}", signature, getpid(), host.data());
  const auto size = static_cast<off_t>(text.size());
  // Only a help for others: a full disk may refuse it.
  if (pwrite(file, text.data(), text.size(), 0) == size) static_cast<void>(!ftruncate(file, size));
}

}  // namespace

FileLock::FileLock(const fs::path& path) : path_(path) {
  // Each refusal throws, and the destructor of what was not constructed does not run.
  const auto refuse = [&](const std::string& why) {
    close(file_);
    throw InputError(why);
  };
  for (;;) {
    file_ = open_if_there(path, O_RDWR);
    const bool created = file_ < 0;
    if (created) file_ = create(path);
    if (file_ < 0) continue;  // another process was faster
    if (!is_lock(file_))
      refuse(
          fmt::format("{} is there and is no lock of this program; move it away, or name another "
                      "file",
                      path.string()));
    const std::string former = holder(file_);
    was_left_ = !created && !read_text(file_).empty();
    own_ = created || was_left_;
    const Taken taken = take(file_);
    if (taken == Taken::no)
      refuse(fmt::format("another run is writing it: {} is held by {}", path.string(), former));
    if (taken == Taken::unknown)
      fmt::print(stderr,
                 "trebsweep: {}: locks do not work here ({}); make sure that no other run writes "
                 "the same archive\n",
                 path.string(), std::strerror(errno));
    if (is_named(file_, path)) break;
    close(file_);
  }
  if (own_) write_holder(file_);
}

FileLock::~FileLock() {
  if (own_) unlink(path_.c_str());  // before the lock goes: nobody else can have it by this name
  close(file_);
}

std::optional<std::string> lock_holder(const fs::path& path) {
  try {
    const int file = open_if_there(path, O_RDONLY);
    if (file < 0) return std::nullopt;
    struct flock whole = whole_file();
    const bool held = is_lock(file) && fcntl(file, F_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
    const std::string who = holder(file);
    close(file);
    return held ? std::optional(who) : std::nullopt;
  } catch (const std::system_error&) {
    return std::nullopt;
  }
}

}  // namespace trebsweep
