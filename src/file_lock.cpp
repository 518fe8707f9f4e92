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

// By fcntl, which also network file systems have.
struct flock whole_file() {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return whole;
}

/// Whether this process has the lock now.
bool take(int file) {
  struct flock whole = whole_file();
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
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length))
                    : "another process";
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

std::optional<std::string> lock_holder(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  struct flock whole = whole_file();
  const bool held = fcntl(file, F_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
  const std::string who = holder(file);
  close(file);
  return held ? std::optional(who) : std::nullopt;
}

}  // namespace trebsweep
