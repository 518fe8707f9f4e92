#include "trebsweep/archive/output_path.hpp"

#include <fmt/format.h>

#include <system_error>

#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"

namespace trebsweep {

namespace fs = std::filesystem;

fs::path partial_path(const fs::path& path) { return path.string() + ".partial"; }

fs::path new_path(const fs::path& path) { return path.string() + ".new"; }

fs::path lock_path(const fs::path& path) { return path.string() + ".lock"; }

void refuse_output(const Job& job, const std::string& why) {
  throw InputError(fmt::format("output.file = {}: {}", shortened(job.output.file), why));
}

fs::path checked_output_path(const Job& job) {
  fs::path path;
  try {
    path = follow_links(job.output.file);
  } catch (const std::system_error& error) {
    refuse_output(job, error.code().message());
  }
  const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored))
    refuse_output(
        job, fmt::format("{} is not a directory; create it, or name another", directory.string()));
  if (const auto kind = irregular_kind(path))
    refuse_output(job, fmt::format("is {}; name a file", *kind));
  for (const fs::path& name : {path, lock_path(path), partial_path(path), new_path(path)}) {
    const bool is_folder = name == partial_path(path);
    std::error_code error;
    const fs::file_status status = fs::symlink_status(name, error);
    if (status.type() == fs::file_type::none)
      refuse_output(job, fmt::format("cannot write in {}: {}: {}", directory.string(),
                                     shortened(name.filename().string()), error.message()));
    if (is_folder && fs::is_directory(status)) continue;
    if (is_folder && fs::is_regular_file(status))
      refuse_output(job,
                    fmt::format("{} is a file; move it away, or name another file", name.string()));
    if (const auto kind = irregular_kind(status))
      refuse_output(
          job, fmt::format("{} is {}; move it away, or name another file", name.string(), *kind));
  }
  // Open MPI 4.1 overruns a buffer if the path of a file is long.
  constexpr std::size_t max_length = 200;
  if (path.string().size() > max_length)
    refuse_output(job,
                  fmt::format("the path is too long: {} characters, at most {} are allowed; give a "
                              "shorter one, such as one relative to the current directory",
                              path.string().size(), max_length));
  return path;
}

}  // namespace trebsweep
