#include "trebsweep/output.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <system_error>

#include "trebsweep/archive.hpp"
#include "trebsweep/error.hpp"
#include "trebsweep/kernel.hpp"
#include "trebsweep/key.hpp"
#include "trebsweep/version.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The keys in which two jobs' maps differ, but for where they go, with both values.
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
bool same_job(const Job& job, const Archived& archived) {
  try {
    return archived.is_sweep && differences(job, parse_job(archived.job, "archived", {})).empty();
  } catch (const InputError&) {
    return false;  // made by a version with other keys
  }
}

/// Reads the partial file of the job. Throws InputError where it is that of another one, and
/// std::runtime_error where this program cannot continue it.
Contents read_begun(const Job& job, const fs::path& partial) {
  const auto readable = [&](const auto& f) {
    try {
      return f();
    } catch (const std::system_error&) {
      throw;  // nothing is known of the file
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(
          fmt::format("{}: {}; it cannot be continued: remove it, or start anew with --overwrite",
                      partial.string(), error.what()));
    }
  };
  const Contents begun = readable([&] { return read_contents(partial); });
  const auto refuse_version = [&](const std::string& what, std::string_view there,
                                  std::string_view here) {
    throw std::runtime_error(
        fmt::format("{} was begun {} {}, this is {}: finish it there, or start anew with "
                    "--overwrite",
                    partial.string(), what, there, here));
  };
  if (begun.source != version_text()) refuse_version("by", begun.source, version_text());
  const Job begun_job = readable([&] { return parse_job(begun.job, partial, {}); });
  const auto differ = differences(job, begun_job);
  if (!differ.empty())
    throw InputError(
        fmt::format("output.file = {}: {} holds an unfinished sweep of another job ({}); name "
                    "another file, or start anew with --overwrite",
                    job.output.file, partial.string(), fmt::join(differ, "; ")));
  if (fuses(begun.kernel) != fuses(instruction_set()))
    refuse_version("on a machine with", begun.kernel, instruction_set());
  const Lattice lattice(job.scene, job.lattice);
  if (begun.axes != lattice.axes() || begun.tiles != Tiling(lattice, begun.tile_edge).size())
    throw std::runtime_error(
        fmt::format("{}: damaged: its lattice is not its job's; it cannot be continued: remove it, "
                    "or start anew "
                    "with --overwrite",
                    partial.string()));
  return begun;
}

[[noreturn]] void refuse_file(const Job& job, const std::string& why) {
  throw InputError(fmt::format("output.file = {}: {}", job.output.file, why));
}

/// The archive that is there already, which `overwrite` allows to replace. Throws InputError where
/// something else is there.
std::optional<Archived> find_archive(const Job& job) {
  std::error_code unknown;  // what cannot be asked about cannot be written either
  if (!fs::exists(job.output.file, unknown)) return std::nullopt;
  auto archived = archived_job(job.output.file);
  if (!archived) refuse_file(job, "is there already and is no archive; name another file");
  return archived;
}

/// Whether the archive of this very job is there already.
bool is_complete(const Job& job, bool overwrite) {
  const auto archived = find_archive(job);
  if (!archived || overwrite) return false;
  if (same_job(job, *archived)) return true;
  refuse_file(job,
              fmt::format("holds {}; name another file, or replace it with --overwrite",
                          archived->is_sweep ? "the archive of another job" : "an assessment"));
}

fs::path folder_of(const Job& job) {
  const fs::path path = job.output.file;
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void check_folder(const Job& job) {
  std::error_code unknown;
  const fs::path folder = folder_of(job);
  if (!fs::is_directory(folder, unknown))
    refuse_file(job, fmt::format("{} is no folder; make it, or name another", folder.string()));
  if (fs::is_directory(job.output.file, unknown)) refuse_file(job, "is a folder; name a file");
}

std::unique_ptr<FileLock> take_lock(const Job& job) {
  try {
    return std::make_unique<FileLock>(job.output.file + ".lock");
  } catch (const InputError& held) {
    refuse_file(job, fmt::format("another run is writing it: {}", held.what()));
  } catch (const std::system_error& error) {
    refuse_file(job, fmt::format("cannot write in {}: {}", folder_of(job).string(),
                                 error.code().message()));
  }
}

}  // namespace

Place prepare_output(const Job& job, bool overwrite) {
  check_folder(job);
  const fs::path partial = partial_path(job.output.file);
  Place place;
  const auto look = [&] {
    // Under another archive's name there is an unfinished one only where that may be replaced.
    const auto begun = archived_job(partial);
    const bool continued = !overwrite && begun && same_job(job, *begun);
    place.complete = !continued && is_complete(job, overwrite);
    return !place.complete;
  };
  if (!look()) return place;
  place.lock = take_lock(job);
  // Another sweep may have finished meanwhile.
  if (!look()) {
    place.lock.reset();
    return place;
  }
  if (!overwrite && fs::exists(partial)) place.begun = read_begun(job, partial);
  return place;
}

std::unique_ptr<FileLock> reserve_output(const Job& job, bool overwrite) {
  check_folder(job);
  auto lock = take_lock(job);
  if (find_archive(job) && !overwrite)
    refuse_file(job, "is there already; name another file, or replace it with --overwrite");
  if (const auto partial = partial_path(job.output.file); fs::exists(partial))
    refuse_file(job,
                fmt::format("{} holds an unfinished sweep; name another file", partial.string()));
  return lock;
}

}  // namespace trebsweep
