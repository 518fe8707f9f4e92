#include "trebsweep/archive/partial.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/study.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PartialSweep, job, source, kernel, numerics, tile_edge, replaces,
                                   history)

namespace {

namespace fs = std::filesystem;

constexpr const char* description = "sweep.json";
constexpr const char* new_description = "sweep.json.new";
constexpr const char* archive = "archive.h5";
constexpr const char* journal_suffix = ".journal";

/// The keys that affect the maps or the optima of scenes and differ between two jobs, with both
/// values.
std::vector<std::string> differences(const Job& here, const Job& there) {
  std::vector<std::string> different;
  for (const Key& key : job_keys()) {
    const std::string value_here = key.get(here), value_there = key.get(there);
    if (key.name == "output.file" || key.name.starts_with("assess.") || value_here == value_there)
      continue;
    const auto text = [](const std::string& value) { return value.empty() ? "none" : value; };
    different.push_back(
        fmt::format("{} = {} there, {} here", key.name, text(value_there), text(value_here)));
  }
  return different;
}

}  // namespace

void write_partial_sweep(const fs::path& folder, const PartialSweep& sweep) {
  const fs::path path = folder / new_description;
  std::ofstream file(path);
  file << nlohmann::json(sweep).dump(2) << '\n';
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
  // A loss of power must not cost the journals of earlier runs.
  if (fs::exists(folder / description)) sync_file(path);
  fs::rename(path, folder / description);
}

PartialSweep read_partial_sweep(const fs::path& folder) {
  const fs::path path = folder / description;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  try {
    const auto sweep = nlohmann::json::parse(file).get<PartialSweep>();
    if (std::ranges::count(sweep.tile_edge, 0) > 0) throw std::runtime_error("tiles of no extent");
    return sweep;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: damaged: {}", path.string(), error.what()));
  }
}

void require_resumable(const Job& job, const fs::path& folder, const PartialSweep& partial) {
  const auto refuse_version = [&](const std::string& what, const auto& there, const auto& here) {
    throw std::runtime_error(
        fmt::format("{} was started {} {}; this is {}: finish it there, or start again with "
                    "--overwrite",
                    folder.string(), what, there, here));
  };
  if (partial.numerics != numerics_version)
    refuse_version(fmt::format("by {}, with numerics", partial.source), partial.numerics,
                   numerics_version);
  const auto different = differences(job, parse_job(partial.job, folder, {}));
  if (!different.empty())
    throw InputError(
        fmt::format("output.file = {}: {} holds an unfinished sweep of another job "
                    "({}); name another file, or start again with --overwrite",
                    shortened(job.output.file), folder.string(), fmt::join(different, "; ")));
  if (has_fma(partial.kernel) != has_fma(instruction_set()))
    refuse_version("on a machine with", partial.kernel, instruction_set());
}

bool is_same_job(const Job& job, const std::string& stored) {
  try {
    return differences(job, parse_job(stored, "archive", {})).empty();
  } catch (const InputError&) {
    return false;  // of a version with other keys
  }
}

fs::path journal_path(const fs::path& folder, std::size_t run, int rank) {
  return folder / fmt::format("{:04}-{:05}{}", run, rank, journal_suffix);
}

std::vector<fs::path> journals_in(const fs::path& folder) {
  std::vector<fs::path> journals;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == journal_suffix) journals.push_back(entry.path());
  std::ranges::sort(journals);
  return journals;
}

fs::path unfinished_archive(const fs::path& folder) { return folder / archive; }

bool is_partial_folder(const fs::path& folder) {
  std::error_code vanished;  // another run may be clearing it
  return std::all_of(fs::directory_iterator(folder, vanished), {}, [](const auto& entry) {
    const fs::path name = entry.path().filename();
    std::error_code ignored;
    const fs::file_status status = entry.symlink_status(ignored);
    return (fs::is_regular_file(status) || !fs::exists(status)) &&
           (name == description || name == new_description || name == archive ||
            name == lock_name || name.extension() == journal_suffix);
  });
}

void clear_partial(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (const fs::path name = entry.path().filename(); name != lock_name && name != description)
      fs::remove(entry.path());
  // Last, because journals without it would be taken for damaged.
  fs::remove(folder / description);
}

}  // namespace trebsweep
