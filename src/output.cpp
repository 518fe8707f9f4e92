#include "trebsweep/output.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "trebsweep/archive.hpp"
#include "trebsweep/error.hpp"

namespace trebsweep {
namespace {

/// Whether two jobs make the same maps in the same form, wherever they go.
bool same_job(Job a, const std::string& archived) {
  try {
    const Job b = parse_job(archived, "archived", {});
    a.output.file = b.output.file;
    return to_text(a) == to_text(b);
  } catch (const InputError&) {
    return false;  // made by a version with other keys
  }
}

}  // namespace

bool prepare_output(const Job& job, bool overwrite) {
  namespace fs = std::filesystem;
  const fs::path path = job.output.file;
  const fs::path partial = Archive::partial_path(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto refuse_file = [&](const std::string& why) {
    throw InputError(fmt::format("output.file = {}: {}", path.string(), why));
  };
  std::error_code unknown;  // what cannot be asked about cannot be written either: open() tells why
  if (!fs::is_directory(folder, unknown))
    refuse_file(fmt::format("{} is no folder; make it, or name another", folder.string()));
  if (fs::is_directory(path, unknown)) refuse_file("is a folder; name a file");
  if (fs::exists(path, unknown)) {
    const auto archived = archived_job(path);
    if (!archived) refuse_file("is there already and is no archive of a sweep; name another file");
    if (!overwrite && same_job(job, *archived)) return false;
    if (!overwrite)
      refuse_file(
          "holds the archive of another job; name another file, or replace it with --overwrite");
  }
  const int file = open(partial.c_str(), O_WRONLY | O_CREAT | (overwrite ? 0 : O_EXCL), 0666);
  if (file < 0 && errno == EEXIST)
    refuse_file(
        fmt::format("{} holds an unfinished sweep; name another file, or start anew with "
                    "--overwrite",
                    partial.string()));
  if (file < 0)
    refuse_file(fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno)));
  close(file);
  return true;
}

}  // namespace trebsweep
