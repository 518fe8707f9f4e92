#include "trebsweep/archive/regular_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace trebsweep {

namespace fs = std::filesystem;

std::optional<std::string> irregular_kind(const fs::file_status& status) {
  if (!fs::exists(status) || fs::is_regular_file(status)) return std::nullopt;
  if (fs::is_directory(status)) return "a directory";
  if (fs::is_symlink(status)) return "a symbolic link";
  if (fs::is_fifo(status)) return "a FIFO";
  if (fs::is_socket(status)) return "a socket";
  if (fs::is_block_file(status) || fs::is_character_file(status)) return "a device";
  return "not a regular file";
}

std::optional<std::string> irregular_kind(const fs::path& path) {
  std::error_code ignored;  // opening the file will report it
  return irregular_kind(fs::status(path, ignored));
}

fs::path directory_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::string file_identity(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0)
    return fmt::format("inode {}, {} bytes, changed at {}.{:09}", status.st_ino, status.st_size,
                       status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
  if (errno == ENOENT) return "";
  throw std::system_error(errno, std::generic_category(), path.string());
}

void sync_file(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  if (file >= 0) close(file);
  if (!synced) throw std::runtime_error("cannot sync " + path.string());
}

fs::path follow_links(fs::path path) {
  constexpr int max_links = 40;  // the limit of Linux
  std::error_code ignored;
  for (int links = 0; fs::is_symlink(fs::symlink_status(path, ignored)); ++links) {
    if (links == max_links)
      throw std::system_error(std::make_error_code(std::errc::too_many_symbolic_link_levels),
                              path.string());
    path = path.parent_path() / fs::read_symlink(path);
  }
  return path;
}

}  // namespace trebsweep
