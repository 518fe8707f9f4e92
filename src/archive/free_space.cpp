#include "trebsweep/archive/free_space.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <limits>

#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/number.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The process's file size limit, bytes.
std::uintmax_t size_limit() {
  rlimit limit{};
  return getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY
             ? limit.rlim_cur
             : std::numeric_limits<std::uintmax_t>::max();
}

/// The size that a file needs, why it cannot have it, and what to do.
std::string shortage_text(std::uintmax_t bytes, const std::string& why) {
  return fmt::format(
      "needs at least {} ({} bytes), {}; set output.maps = none, output.storage = float32, fewer "
      "output.fields, an output.compression or a larger lattice.increment",
      size_text(bytes), bytes, why);
}

}  // namespace

void require_space(const Job& job, const fs::path& path, std::uintmax_t bytes, std::uintmax_t all) {
  if (const auto limit = size_limit(); bytes > limit)
    refuse_output(job, shortage_text(bytes, fmt::format("but the file size limit (ulimit -f) is {}",
                                                        size_text(limit))));
  const fs::path directory = directory_of(path);
  std::error_code error;
  const auto space = fs::space(directory, error);
  if (!error && all > space.available)
    refuse_output(job, shortage_text(all, fmt::format("but only {} ({} bytes) are available in {}",
                                                      size_text(space.available), space.available,
                                                      directory.string())) +
                           ", or name another directory");
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
