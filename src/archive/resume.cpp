#include "trebsweep/archive/resume.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/output_path.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/tiling.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

/// The keys that affect the maps or the optima of scenes and differ between two jobs, with both
/// values.
std::vector<std::string> differences(const Job& here, const Job& there) {
  // Of a study, it decides whether the optima of the scenes have an error.
  const bool check_matters = is_study(here);
  std::vector<std::string> different;
  for (const Key& key : job_keys()) {
    const std::string value_here = key.get(here), value_there = key.get(there);
    if (key.name == "output.file" || (key.name == "solver.check" && !check_matters) ||
        key.name.starts_with("assess.") || value_here == value_there)
      continue;
    const auto text = [](const std::string& value) { return value.empty() ? "none" : value; };
    different.push_back(
        fmt::format("{} = {} there, {} here", key.name, text(value_there), text(value_here)));
  }
  return different;
}

/// Calls `read`, and adds to the message of a failure that the partial archive cannot be continued.
template <class F>
auto read_or_explain(const std::filesystem::path& partial, F read) {
  try {
    return read();
  } catch (const std::system_error&) {
    throw;  // nothing is known about the file
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("{}: {}; it cannot be continued: remove it, or start again with --overwrite",
                    partial.string(), error.what()));
  }
}

[[noreturn]] void refuse_version(const std::filesystem::path& partial, const std::string& what,
                                 std::string_view there, std::string_view here) {
  throw std::runtime_error(
      fmt::format("{} was started {} {}; this is {}: finish it there, or start again with "
                  "--overwrite",
                  partial.string(), what, there, here));
}

}  // namespace

bool is_same_job(const Job& job, const ArchiveHeader& archive) {
  try {
    return archive.is_sweep && differences(job, parse_job(archive.job, "archive", {})).empty();
  } catch (const InputError&) {
    return false;  // created by a version with other keys
  }
}

ArchiveContents read_resumable(const Job& job, const std::filesystem::path& partial) {
  const ArchiveContents contents = read_or_explain(partial, [&] { return read_contents(partial); });
  if (contents.source != version_text())
    refuse_version(partial, "by", contents.source, version_text());
  const Job partial_job =
      read_or_explain(partial, [&] { return parse_job(contents.job, partial, {}); });
  const auto different = differences(job, partial_job);
  if (!different.empty())
    refuse_output(job, fmt::format("{} holds an unfinished sweep of another job ({}); name another "
                                   "file, or start again with --overwrite",
                                   partial.string(), fmt::join(different, "; ")));
  if (has_fma(contents.kernel) != has_fma(instruction_set()))
    refuse_version(partial, "on a machine with", contents.kernel, instruction_set());
  const Study study(job);
  read_or_explain(partial, [&] { return contents.tiling(study); });
  return contents;
}

}  // namespace trebsweep
