#include "trebsweep/archive/resume.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

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

[[noreturn]] void refuse_version(const std::filesystem::path& folder, const std::string& what,
                                 std::string_view there, std::string_view here) {
  throw std::runtime_error(
      fmt::format("{} was started {} {}; this is {}: finish it there, or start again with "
                  "--overwrite",
                  folder.string(), what, there, here));
}

}  // namespace

bool is_same_job(const Job& job, const std::string& stored) {
  try {
    return differences(job, parse_job(stored, "archive", {})).empty();
  } catch (const InputError&) {
    return false;  // of a version with other keys
  }
}

void require_resumable(const Job& job, const std::filesystem::path& folder,
                       const PartialSweep& partial) {
  if (partial.numerics != numerics_version)
    refuse_version(folder, fmt::format("by {}, with numerics", partial.source),
                   fmt::to_string(partial.numerics), fmt::to_string(numerics_version));
  const auto different = differences(job, parse_job(partial.job, folder, {}));
  if (!different.empty())
    refuse_output(job, fmt::format("{} holds an unfinished sweep of another job ({}); name another "
                                   "file, or start again with --overwrite",
                                   folder.string(), fmt::join(different, "; ")));
  if (has_fma(partial.kernel) != has_fma(instruction_set()))
    refuse_version(folder, "on a machine with", partial.kernel, instruction_set());
}

}  // namespace trebsweep
