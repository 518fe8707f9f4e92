#include "trebsweep/archive/free_space.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <stdexcept>

#include "trebsweep/archive/output_file.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

fs::path directory_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// The process's file size limit, bytes.
std::uintmax_t size_limit() {
  rlimit limit{};
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
             ? limit.rlim_cur
             : std::numeric_limits<std::uintmax_t>::max();
}

/// Whether a quota forbids a file of the given size, found by allocating it for a moment. False if
/// the file system cannot allocate without writing.
bool quota_forbids([[maybe_unused]] const fs::path& path, [[maybe_unused]] std::uintmax_t bytes) {
  int error = 0;
#ifdef __linux__
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) return false;  // creating the real file will report why
  if (fallocate(file, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) != 0) error = errno;
  close(file);
  unlink(path.c_str());
#endif
  return error == EDQUOT || error == ENOSPC;
}

/// The size that a file needs, why it cannot have it, and what to do.
std::string shortage_text(std::uintmax_t bytes, const std::string& why) {
  return fmt::format(
      "needs at least {} ({} bytes), {}; set output.maps = none, output.storage = float32, fewer "
      "output.fields, an output.compression or a larger lattice.increment, or name another "
      "directory",
      size_text(bytes), bytes, why);
}

}  // namespace

std::string size_text(std::uintmax_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size >= 1e9) return fmt::format("{:.4g} GB", size / 1e9);
  return bytes >= 1'000'000 ? fmt::format("{:.4g} MB", size / 1e6) : fmt::format("{} bytes", bytes);
}

void require_space(const Job& job, const fs::path& path, std::uintmax_t bytes, std::uintmax_t all) {
  const auto fail = [&](std::uintmax_t size, const std::string& why) {
    throw std::runtime_error(fmt::format("{} {}", path.string(), shortage_text(size, why)));
  };
  if (const auto limit = size_limit(); bytes > limit)
    fail(bytes, fmt::format("but the file size limit (ulimit -f) is {}", size_text(limit)));
  const fs::path directory = directory_of(path);
  std::error_code error;
  const auto space = fs::space(directory, error);
  if (!error && all > space.available)
    refuse_output(job, shortage_text(all, fmt::format("but only {} ({} bytes) are available in {}",
                                                      size_text(space.available), space.available,
                                                      directory.string())));
  if (quota_forbids(path, all))
    fail(all, fmt::format("more than a quota in {} allows", directory.string()));
}

std::string reached_limit(const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  if (!error && size >= size_limit()) return ", which has reached the file size limit (ulimit -f)";
  constexpr std::uintmax_t scarce = 1 << 16;
  const auto space = fs::space(path, error);
  if (!error && space.available < scarce) return ", whose disk has no space left";
  return "";
}

}  // namespace trebsweep
