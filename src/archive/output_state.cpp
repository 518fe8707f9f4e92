#include "trebsweep/archive/output_state.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/archive_header.hpp"
#include "trebsweep/archive/output_path.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/archive/resume.hpp"
#include "trebsweep/base/error.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// Throws InputError if a file that is being created may belong to somebody else: a killed run
/// leaves a stale lock, and a file that is empty or has the HDF5 signature.
void check_new_file(const Job& job, const fs::path& path, const FileLock& lock) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, signature.size()> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  const bool is_hdf5 = std::string_view(start.data(), start.size()) == signature;
  if (file.gcount() > 0 && !(is_hdf5 && lock.was_stale()))
    refuse_output(job,
                  fmt::format("{} exists and was not left by an interrupted run; move it away, or "
                              "name another file",
                              path.string()));
}

std::unique_ptr<FileLock> lock_output(const Job& job, const fs::path& path) {
  std::unique_ptr<FileLock> lock;
  try {
    lock = std::make_unique<FileLock>(lock_path(path));
  } catch (const InputError& error) {
    refuse_output(job, error.what());
  } catch (const std::system_error& error) {
    refuse_output(
        job, fmt::format("cannot write {}: {}", lock_path(path).string(), error.code().message()));
  }
  return lock;
}

/// The header of the existing archive, if any. Throws InputError if the file is not an archive.
std::optional<ArchiveHeader> find_archive(const Job& job, const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  auto archive = read_archive_header(path);
  if (!archive) refuse_output(job, "already exists and is not an archive; name another file");
  return archive;
}

/// What the existing folder of a partial sweep says, if anything. Throws InputError if the folder
/// is not one.
std::optional<PartialSweep> find_partial(const Job& job, const fs::path& path) {
  const fs::path folder = partial_path(path);
  if (!fs::exists(folder)) return std::nullopt;
  const bool is_ours = is_partial_folder(folder);
  try {
    if (is_ours) return read_partial_sweep(folder);
  } catch (const std::runtime_error&) {
    if (journals_in(folder).empty()) return std::nullopt;  // killed while it was created
  }
  refuse_output(
      job, fmt::format("{} exists and is not an unfinished sweep, or is damaged; move it away, or "
                       "name another file",
                       folder.string()));
}

/// Throws InputError if an archive is not the complete one of this job. `remedy` is what the
/// message advises for an archive of another job.
void require_complete(const Job& job, const fs::path& path, const ArchiveHeader& archive,
                      const std::string& remedy) {
  const auto refuse = [&](const std::string& what, const std::string& what_to_do) {
    refuse_output(job,
                  fmt::format("holds {}; {}, or replace it with --overwrite", what, what_to_do));
  };
  if (!archive.is_sweep) refuse("an assessment", remedy);
  if (!is_same_job(job, archive.job)) refuse("the archive of another job", remedy);
  if (!archive.complete())
    refuse(fmt::format("a snapshot of this job, {} of {} tiles done", archive.tiles_done,
                       archive.tiles),
           remedy);
  try {
    read_contents(path).tally();
  } catch (const std::runtime_error& error) {
    refuse(fmt::format("an archive of this job that cannot be used ({})", error.what()), remedy);
  }
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

}  // namespace

OutputState open_or_resume(const Job& job, bool overwrite) {
  OutputState state;
  state.path = checked_output_path(job);
  // If nothing remains to be done, the path need not be writable, nor locked.
  state.complete = !fs::exists(partial_path(state.path)) &&
                   is_complete(job, state.path, overwrite, std::nullopt);
  if (state.complete) return state;
  state.lock = lock_output(job, state.path);
  const fs::path folder = partial_path(state.path);
  const auto partial = find_partial(job, state.path);
  state.complete = is_complete(job, state.path, overwrite, partial);
  state.replaces = file_identity(state.path);
  if (state.complete) {
    // A run was killed after it had renamed the archive.
    if (partial && is_same_job(job, partial->job)) remove_partial(folder);
    state.lock.reset();
  } else if (partial && !overwrite) {
    require_resumable(job, folder, *partial);
    state.partial = partial;
  }
  return state;
}

OutputState reserve_output(const Job& job, bool overwrite) {
  OutputState state;
  state.path = checked_output_path(job);
  state.lock = lock_output(job, state.path);
  check_new_file(job, new_path(state.path), *state.lock);
  if (find_archive(job, state.path) && !overwrite)
    refuse_output(job, "already exists; name another file, or replace it with --overwrite");
  state.replaces = file_identity(state.path);
  if (fs::exists(partial_path(state.path)))
    refuse_output(job, fmt::format("{} holds an unfinished sweep; name another file",
                                   partial_path(state.path).string()));
  return state;
}

}  // namespace trebsweep
