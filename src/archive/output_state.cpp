#include "trebsweep/archive/output_state.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The keys in which two jobs' maps differ, except for where they go, with both values.
std::vector<std::string> differences(const Job& here, const Job& there) {
  std::vector<std::string> found;
  for (const Key& key : job_keys()) {
    const std::string mine = key.get(here), other = key.get(there);
    if (key.name == "output.file" || key.name.starts_with("assess.") || mine == other) continue;
    const auto said = [](const std::string& value) { return value.empty() ? "none" : value; };
    found.push_back(fmt::format("{} = {} there, {} here", key.name, said(other), said(mine)));
  }
  return found;
}

/// Whether two jobs make the same maps in the same form.
bool same_job(const Job& job, const ArchiveHeader& archived) {
  try {
    return archived.is_sweep && differences(job, parse_job(archived.job, "archived", {})).empty();
  } catch (const InputError&) {
    return false;  // made by a version with other keys
  }
}

/// Reads the partial file of the job. Throws InputError where it is that of another one, and
/// std::runtime_error where this program cannot continue it.
ArchiveContents read_begun(const Job& job, const fs::path& partial) {
  const auto readable = [&](const auto& f) {
    try {
      return f();
    } catch (const std::system_error&) {
      throw;  // nothing is known of the file
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(
          fmt::format("{}: {}; it cannot be continued: remove it, or start again with --overwrite",
                      partial.string(), error.what()));
    }
  };
  const ArchiveContents begun = readable([&] { return read_contents(partial); });
  const auto refuse_version = [&](const std::string& what, std::string_view there,
                                  std::string_view here) {
    throw std::runtime_error(
        fmt::format("{} was begun {} {}, this is {}: finish it there, or start again with "
                    "--overwrite",
                    partial.string(), what, there, here));
  };
  if (begun.source != version_text()) refuse_version("by", begun.source, version_text());
  const Job begun_job = readable([&] { return parse_job(begun.job, partial, {}); });
  const auto differ = differences(job, begun_job);
  if (!differ.empty())
    throw InputError(
        fmt::format("output.file = {}: {} holds an unfinished sweep of another job ({}); name "
                    "another file, or start again with --overwrite",
                    job.output.file, partial.string(), fmt::join(differ, "; ")));
  if (has_fma(begun.kernel) != has_fma(instruction_set()))
    refuse_version("on a machine with", begun.kernel, instruction_set());
  const Lattice lattice(job.scene, job.lattice);
  if (begun.axes != lattice.axes() || begun.tiles != Tiling(lattice, begun.tile_edge).size())
    throw std::runtime_error(
        fmt::format("{}: damaged: its lattice is not its job's; it cannot be continued: remove it, "
                    "or start again with --overwrite",
                    partial.string()));
  return begun;
}

[[noreturn]] void refuse_file(const Job& job, const std::string& why) {
  throw InputError(fmt::format("output.file = {}: {}", shortened(job.output.file), why));
}

fs::path lock_path(const fs::path& path) { return path.string() + ".lock"; }

/// The job's output file, links followed. Throws InputError where it, or a file next to it that a
/// run needs, cannot have its name, or where there is something else than a regular file.
fs::path check_names(const Job& job) {
  fs::path path;
  try {
    path = follow_links(job.output.file);
  } catch (const std::system_error& error) {
    refuse_file(job, error.code().message());
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code unknown;
  if (!fs::is_directory(folder, unknown))
    refuse_file(job, fmt::format("{} is no folder; make it, or name another", folder.string()));
  if (const auto kind = irregular_kind(path))
    refuse_file(job, fmt::format("is {}; name a file", *kind));
  for (const fs::path& name : {path, lock_path(path), partial_path(path), new_path(path)}) {
    std::error_code error;
    const fs::file_status status = fs::symlink_status(name, error);
    if (status.type() == fs::file_type::none)
      refuse_file(job, fmt::format("cannot write in {}: {}: {}", folder.string(),
                                   shortened(name.filename().string()), error.message()));
    if (const auto kind = irregular_kind(status))
      refuse_file(
          job, fmt::format("{} is {}; move it away, or name another file", name.string(), *kind));
  }
  // Open MPI 4.1 overruns a buffer where the path of a file is long.
  constexpr std::size_t longest = 200;
  if (path.string().size() > longest)
    refuse_file(job,
                fmt::format("the path is too long: {} characters, at most {} are allowed; give "
                            "a shorter one, such as one relative to the current folder",
                            path.string().size(), longest));
  return path;
}

/// Takes the lock, and looks for what may not be replaced under the name of the new file.
std::unique_ptr<FileLock> take_lock(const Job& job, const fs::path& path) {
  std::unique_ptr<FileLock> lock;
  try {
    lock = std::make_unique<FileLock>(lock_path(path));
  } catch (const InputError& error) {
    refuse_file(job, error.what());
  } catch (const std::system_error& error) {
    refuse_file(
        job, fmt::format("cannot write {}: {}", lock_path(path).string(), error.code().message()));
  }
  // A killed run leaves its lock, and an empty file there or one that starts as every HDF5 file.
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, signature.size()> start{};
  std::ifstream file(new_path(path), std::ios::binary);
  file.read(start.data(), start.size());
  const bool is_hdf5 = std::string_view(start.data(), start.size()) == signature;
  if (file.gcount() > 0 && !(is_hdf5 && lock->was_left()))
    refuse_file(job,
                fmt::format("{} is there and was not left by an interrupted run; move it away, "
                            "or name another file",
                            new_path(path).string()));
  return lock;
}

/// The archive that is there already. Throws InputError where something else is.
std::optional<ArchiveHeader> find_archive(const Job& job, const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  auto archived = read_archive_header(path);
  if (!archived) refuse_file(job, "is there already and is no archive; name another file");
  return archived;
}

/// The unfinished sweep that is there already. Throws InputError where something else is.
std::optional<ArchiveHeader> find_partial(const Job& job, const fs::path& path) {
  const fs::path partial = partial_path(path);
  if (!fs::exists(partial)) return std::nullopt;
  auto begun = read_archive_header(partial);
  if (!begun || !begun->is_sweep)
    refuse_file(
        job, fmt::format("{} is there and is no unfinished sweep, or is damaged; move it away, or "
                         "name another file",
                         partial.string()));
  return begun;
}

/// Throws InputError where an archive is not the complete one of this very job. `remedy` says what
/// to do about another one.
void require_same(const Job& job, const fs::path& path, const ArchiveHeader& archived,
                  const std::string& remedy) {
  const auto refuse = [&](const std::string& what, const std::string& what_to_do) {
    refuse_file(job, fmt::format("holds {}; {}, or replace it with --overwrite", what, what_to_do));
  };
  if (!archived.is_sweep) refuse("an assessment", remedy);
  if (!same_job(job, archived))
    refuse(fmt::format("the {}archive of another job", archived.complete() ? "" : "unfinished "),
           remedy);
  if (!archived.complete())
    refuse(fmt::format("an unfinished archive of this job, {} of {} tiles done",
                       archived.tiles_done, archived.tiles),
           fs::exists(partial_path(path))
               ? remedy
               : fmt::format("rename it to {} to continue it", partial_path(path).string()));
  try {
    read_contents(path);
  } catch (const std::system_error&) {
    throw;  // nothing is known of the file
  } catch (const std::runtime_error& error) {
    refuse(fmt::format("an archive of this job that cannot be used ({})", error.what()), remedy);
  }
}

/// Whether the complete archive of this very job is there. Throws InputError where another archive
/// is there that may not be replaced.
bool is_complete(const Job& job, const fs::path& path, bool overwrite,
                 const std::optional<ArchiveHeader>& begun) {
  const auto archived = find_archive(job, path);
  // A partial file that was begun with --overwrite may replace the archive of that time alone.
  const bool continued = begun && same_job(job, *begun);
  const bool may_replace = overwrite || (continued && begun->replaces == file_identity(path));
  if (!archived || may_replace) return false;
  require_same(job, path, *archived,
               continued ? "move it away to continue the unfinished sweep" : "name another file");
  return true;
}

}  // namespace

OutputState open_or_resume(const Job& job, bool overwrite) {
  OutputState place;
  place.path = check_names(job);
  // Where nothing remains to be done, nothing is locked.
  place.complete = !fs::exists(partial_path(place.path)) &&
                   is_complete(job, place.path, overwrite, std::nullopt);
  if (place.complete) return place;
  place.lock = take_lock(job, place.path);
  const auto begun = find_partial(job, place.path);
  place.complete = is_complete(job, place.path, overwrite, begun);
  place.replaces = file_identity(place.path);
  if (place.complete)
    place.lock.reset();
  else if (begun && !overwrite)
    place.begun = read_begun(job, partial_path(place.path));
  return place;
}

OutputState reserve_output(const Job& job, bool overwrite) {
  OutputState place;
  place.path = check_names(job);
  place.lock = take_lock(job, place.path);
  if (find_archive(job, place.path) && !overwrite)
    refuse_file(job, "is there already; name another file, or replace it with --overwrite");
  place.replaces = file_identity(place.path);
  if (fs::exists(partial_path(place.path)))
    refuse_file(job, fmt::format("{} holds an unfinished sweep; name another file",
                                 partial_path(place.path).string()));
  return place;
}

}  // namespace trebsweep
