#include "trebsweep/cli/info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/archive_contents.hpp"
#include "trebsweep/archive/archive_header.hpp"
#include "trebsweep/archive/assessment_contents.hpp"
#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/archive/output_path.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/archive/summary.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The path that a partial archive gets when it is complete.
fs::path final_path(const fs::path& partial) { return fs::path(partial).replace_extension(); }

/// The progress of an archive, and how to continue it if it is unfinished.
std::string progress_text(const fs::path& given, const ArchiveContents& contents) {
  const fs::path path = follow_links(given);
  const bool partial = path.extension() == ".partial";
  const fs::path archive = partial ? final_path(path) : path;
  const auto writer = lock_holder(lock_path(archive));
  if (contents.complete() && !partial) return "complete";
  const std::string progress =
      contents.complete()
          ? "complete, not yet renamed"
          : fmt::format("unfinished, {:.1f} % of the tiles done",
                        100 * static_cast<double>(contents.tiles_done) /
                            static_cast<double>(std::max<std::uint64_t>(1, contents.tiles)));
  if (writer) return fmt::format("{}; being written by {}", progress, *writer);
  if (partial) return progress + "; interrupted: run the command of the sweep again to continue it";
  return fmt::format("{}; to continue it, rename it to {}", progress, partial_path(path).string());
}

std::string describe_assessment(const fs::path& path) {
  const AssessmentContents contents = read_assessment(path);
  return fmt::format("archive   {}, an assessment\ntables    {}\nsource    {}\nhistory   {}\n\n{}",
                     path.string(), fmt::join(contents.tables, ", "), contents.source,
                     boost::replace_all_copy(contents.history, "\n", "\n          "), contents.job);
}

std::string describe_sweep(const fs::path& path) {
  const ArchiveContents contents = read_contents(path);
  const Job job = parse_job(contents.job, path, {});
  std::string text =
      fmt::format("archive   {}, {}\n", path.string(), progress_text(path, contents));
  text += fmt::format("scene     {}\nsolver    {}\n", contents.scene, solver_text(job.solver));
  text += fmt::format("tiles     {} of {} done, of {} designs (r1 x r3 x r2)\n",
                      contents.tiles_done, contents.tiles, fmt::join(contents.tile_edge, " x "));
  text += fmt::format("lattice   {} x {} x {} (r1 x r3 x r2), {} designs\n",
                      contents.axes[0].size(), contents.axes[1].size(), contents.axes[2].size(),
                      Lattice(job.scene, job.lattice).designs());
  Summary summary = to_summary(contents.tally, contents.axes);
  summary.error = contents.error;
  text += to_text(summary, job.output.optimum_filter);
  text += fmt::format("\nsource    {}, {}\n", contents.source, contents.kernel);
  text += "history   " + boost::replace_all_copy(contents.history, "\n", "\n          ");
  return text + "\n\n" + contents.job;
}

/// The path itself if the file exists, otherwise that of its partial archive.
fs::path find(const fs::path& given) {
  try {
    if (fs::exists(given)) return given;
    if (const auto partial = partial_path(follow_links(given)); fs::exists(partial)) return partial;
  } catch (const std::system_error&) {
    // A cycle of links, or an invalid file name.
  }
  throw InputError(
      fmt::format("{}: no such file; give the path of an archive", shortened(given.string())));
}

}  // namespace

std::string describe_archive(const fs::path& given) {
  const fs::path path = find(given);
  if (const auto kind = irregular_kind(path))
    throw InputError(fmt::format("{} is {}; give the path of an archive", path.string(), *kind));
  try {
    const auto archived = read_archive_header(path);
    return archived && !archived->is_sweep ? describe_assessment(path) : describe_sweep(path);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("{}: {}; not an archive of this format version, or a damaged one",
                    path.string(), error.what()));
  }
}

}  // namespace trebsweep
