#include "trebsweep/archive/output_file.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The path of a job's archive, links followed. Throws InputError if it can never be one.
fs::path checked_path(const Job& job) {
  const fs::path path = follow_links(job.output.file);
  const fs::path directory = directory_of(path);
  std::error_code ignored;
  if (!fs::is_directory(directory, ignored))
    refuse_output(
        job, fmt::format("{} is not a directory; create it, or name another", directory.string()));
  if (const auto kind = irregular_kind(path))
    refuse_output(job, fmt::format("is {}; name a file", *kind));
  // Open MPI 4.1 overruns a buffer if the path of a file is long.
  constexpr std::size_t max_length = 200;
  if (path.string().size() > max_length)
    refuse_output(job,
                  fmt::format("the path is too long: {} characters, at most {} are allowed; give a "
                              "shorter one, such as one relative to the current directory",
                              path.string().size(), max_length));
  return path;
}

/// Reports a failure of the file system, as at names that are too long.
[[noreturn]] void refuse_output(const Job& job, const std::system_error& error) {
  refuse_output(job, fmt::format("cannot write in {}: {}", directory_of(job.output.file).string(),
                                 error.code().message()));
}

/// Throws InputError if what has the name of the folder is not what this program creates.
void check_folder(const Job& job, const fs::path& folder) {
  const fs::file_status status = fs::symlink_status(folder);
  const bool is_directory = fs::is_directory(status);
  if (!fs::exists(status) || (is_directory && is_partial_folder(folder))) return;
  const std::string what = is_directory ? "exists and is not an unfinished sweep"
                                        : "is " + irregular_kind(status).value_or("a file");
  refuse_output(job,
                fmt::format("{} {}; move it away, or name another file", folder.string(), what));
}

/// The header of the existing archive, if any. Throws InputError if the file is not an archive.
std::optional<ArchiveHeader> find_archive(const Job& job, const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  try {
    return read_header(path);
  } catch (const std::runtime_error&) {
    refuse_output(job, "already exists and is not an archive; name another file");
  }
}

/// The unfinished sweep in a folder, if any. Throws InputError if it is damaged.
std::optional<PartialSweep> find_partial(const Job& job, const fs::path& folder) {
  if (!fs::exists(folder)) return std::nullopt;
  try {
    return read_partial_sweep(folder);
  } catch (const std::runtime_error&) {
    if (journals_in(folder).empty()) return std::nullopt;  // killed while it was created
    refuse_output(
        job, fmt::format("{} is damaged; move it away, or name another file", folder.string()));
  }
}

/// Throws InputError if an archive is not the complete one of this job. `remedy` is what the
/// message advises.
void require_complete(const Job& job, const fs::path& path, const ArchiveHeader& archive,
                      const std::string& remedy) {
  const auto refuse = [&](const std::string& what) {
    refuse_output(job, fmt::format("holds {}; {}, or replace it with --overwrite", what, remedy));
  };
  if (!archive.is_sweep()) refuse("an assessment");
  if (!is_same_job(job, archive.job)) refuse("the archive of another job");
  std::string problem;
  try {
    const ArchiveContents contents = read_contents(path);
    if (!contents.summary.complete)
      problem = fmt::format("a snapshot of this job, {} of {} tiles done", contents.tiles_done,
                            contents.tiles.size());
  } catch (const std::runtime_error& error) {
    problem = fmt::format("an archive of this job that cannot be used ({})", error.what());
  }
  if (!problem.empty()) refuse(problem);
}

/// Whether the complete archive of this job exists. Throws InputError if another archive exists
/// that may not be replaced.
bool is_complete(const Job& job, const fs::path& path, bool overwrite,
                 const std::optional<PartialSweep>& partial) {
  const auto archive = find_archive(job, path);
  // A run that was started with --overwrite may be resumed without it, but may replace only the
  // archive that existed at its start.
  const bool resumes = partial && is_same_job(job, partial->job);
  const bool may_replace = overwrite || (resumes && partial->replaces == file_identity(path));
  if (!archive || may_replace) return false;
  require_complete(job, path, *archive,
                   resumes ? "move it away to continue the unfinished sweep" : "name another file");
  return true;
}

/// The locked path of an archive; not locked unless it is to be reserved.
OutputFile lock_output(const Job& job, const fs::path& path, Reserve reserve) {
  check_folder(job, partial_path(path));
  OutputFile output{.path = path, .partial = {}, .replaces = {}, .lock = {}};
  try {
    if (reserve == Reserve::yes)
      output.lock = std::make_unique<FileLock>(partial_path(path));
    else
      require_lockable(partial_path(path));
  } catch (const InputError& error) {
    refuse_output(job, error.what());
  }
  output.replaces = file_identity(path);
  return output;
}

}  // namespace

fs::path partial_path(const fs::path& path) { return path.string() + ".partial"; }

void refuse_output(const Job& job, const std::string& why) {
  throw InputError(fmt::format("output.file = {}: {}", shortened(job.output.file), why));
}

OutputFile open_or_resume(const Job& job, bool overwrite, Reserve reserve) try {
  const fs::path path = checked_path(job), folder = partial_path(path);
  // If nothing remains to be done, the path need not be writable, nor locked.
  if (!fs::exists(fs::symlink_status(folder)) && is_complete(job, path, overwrite, std::nullopt))
    return {.path = path, .complete = true, .partial = {}, .replaces = {}, .lock = {}};
  OutputFile output = lock_output(job, path, reserve);
  const auto partial = find_partial(job, folder);
  output.complete = is_complete(job, path, overwrite, partial);
  if (output.complete) {
    // A run was killed after it had renamed the archive.
    if (reserve == Reserve::yes && partial && is_same_job(job, partial->job)) clear_partial(folder);
    output.lock.reset();
  } else if (partial && !overwrite) {
    require_resumable(job, folder, *partial);
    output.partial = partial;
  }
  return output;
} catch (const std::system_error& error) {
  refuse_output(job, error);
}

OutputFile reserve_output(const Job& job, bool overwrite, Reserve reserve) try {
  const fs::path path = checked_path(job), folder = partial_path(path);
  OutputFile output = lock_output(job, path, reserve);
  if (find_archive(job, path) && !overwrite)
    refuse_output(job, "already exists; name another file, or replace it with --overwrite");
  if (find_partial(job, folder))
    refuse_output(job,
                  fmt::format("{} holds an unfinished sweep; name another file", folder.string()));
  if (reserve == Reserve::yes) clear_partial(folder);
  return output;
} catch (const std::system_error& error) {
  refuse_output(job, error);
}

void finish_output(const OutputFile& output) {
  const fs::path folder = partial_path(output.path), from = unfinished_archive(folder);
  sync_file(from);
  if (fs::exists(fs::symlink_status(output.path)) && file_identity(output.path) != output.replaces)
    throw std::runtime_error(
        fmt::format("cannot rename {} to {}: a file with that name has appeared in the meantime; "
                    "move it away, and the same command will finish the archive",
                    from.string(), output.path.string()));
  fs::rename(from, output.path);
  try {
    clear_partial(folder);
  } catch (const std::runtime_error&) {
    // The archive is complete; the next run removes what remains.
  }
}

}  // namespace trebsweep
