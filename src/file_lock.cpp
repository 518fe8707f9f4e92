#include "trebsweep/file_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "trebsweep/error.hpp"

namespace trebsweep {
namespace {

int open_file(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) throw std::system_error(errno, std::generic_category());
  return file;
}

/// Whether this process has the lock now. By fcntl, which also network file systems have.
bool take(int file) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(file, F_SETLK, &whole) == 0 || (errno != EACCES && errno != EAGAIN);
}

/// Whether the file still has its name: a former holder may just have removed it.
bool is_named(int file, const std::filesystem::path& path) {
  struct stat opened {
  }, named{};
  return fstat(file, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

std::string holder(int file) {
  std::array<char, 300> text{};
  const auto length = pread(file, text.data(), text.size(), 0);
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

void tell_holder(int file) {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string text = fmt::format("process {} on {}", getpid(), host.data());
  // Only a help for others: a full disk may refuse it.
  if (ftruncate(file, 0) == 0) static_cast<void>(!pwrite(file, text.data(), text.size(), 0));
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path) : path_(path), file_(open_file(path)) {
  for (;;) {
    if (!take(file_)) {
      const std::string who = holder(file_);
      close(file_);
      throw InputError(
          fmt::format("{} is held by {}", path.string(), who.empty() ? "another process" : who));
    }
    if (is_named(file_, path)) break;
    close(file_);
    file_ = open_file(path);
  }
  tell_holder(file_);
}

FileLock::~FileLock() {
  unlink(path_.c_str());  // before the lock goes: nobody else can have it under this name
  close(file_);
}

}  // namespace trebsweep
