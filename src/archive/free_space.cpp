#include "trebsweep/archive/free_space.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <stdexcept>

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

std::string size_text(std::uintmax_t bytes) {
  const auto size = static_cast<double>(bytes);
  if (size >= 1e9) return fmt::format("{:.4g} GB", size / 1e9);
  return bytes >= 1'000'000 ? fmt::format("{:.4g} MB", size / 1e6) : fmt::format("{} bytes", bytes);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// The largest file that this process may write, bytes.
std::uintmax_t size_limit() {
  rlimit limit{};
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
             ? limit.rlim_cur
             : std::numeric_limits<std::uintmax_t>::max();
}

/// Whether a quota forbids a file of that size. Asked by taking the space for a moment, where the
/// file system does so at once; else the answer is no.
bool quota_forbids([[maybe_unused]] const fs::path& path, [[maybe_unused]] std::uintmax_t bytes) {
  int error = 0;
#ifdef __linux__
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file < 0) return false;  // creating it in earnest tells why
  if (fallocate(file, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) != 0) error = errno;
  close(file);
  unlink(path.c_str());
#endif
  return error == EDQUOT || error == ENOSPC || error == EFBIG;
}

[[noreturn]] void refuse(const fs::path& path, std::uintmax_t bytes, const std::string& why) {
  throw std::runtime_error(fmt::format(
      "{} needs at least {} ({} bytes), {}; set output.storage = float32, fewer output.fields, an "
      "output.compression or a larger lattice.increment, or choose another place",
      path.string(), size_text(bytes), bytes, why));
}

}  // namespace

void require_space(const fs::path& path, std::uintmax_t bytes) {
  if (const auto limit = size_limit(); bytes > limit)
    refuse(path, bytes,
           fmt::format("and the limit of file size (ulimit -f) is {}", size_text(limit)));
  const fs::path folder = folder_of(path);
  std::error_code unknown;
  const auto space = fs::space(folder, unknown);
  if (!unknown && bytes > space.available)
    refuse(path, bytes,
           fmt::format("and {} ({} bytes) are available in {}", size_text(space.available),
                       space.available, folder.string()));
  if (quota_forbids(path, bytes))
    refuse(path, bytes, fmt::format("more than a quota in {} allows", folder.string()));
}

std::string obstacle(const fs::path& path) {
  std::error_code unknown;
  const auto size = fs::file_size(path, unknown);
  if (!unknown && size >= size_limit()) return ", its limit of size (ulimit -f) is reached";
  constexpr std::uintmax_t scarce = 1 << 16;
  const auto space = fs::space(path, unknown);
  if (!unknown && space.available < scarce) return ", no space is left on its disk";
  return "";
}

}  // namespace trebsweep
