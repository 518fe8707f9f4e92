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
#include "trebsweep/archive/verify.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

bool is_partial(const fs::path& path) { return path.extension() == ".partial"; }

/// The path that an archive has when it is complete.
fs::path final_path(const fs::path& given) {
  const fs::path path = follow_links(given);
  return is_partial(path) ? fs::path(path).replace_extension() : path;
}

/// The process that is writing an archive, if any.
std::optional<std::string> writer_of(const fs::path& path) {
  return lock_holder(lock_path(final_path(path)));
}

/// The progress of an archive, and how to continue it if it is unfinished.
std::string progress_text(const fs::path& given, const ArchiveContents& contents) {
  const fs::path path = follow_links(given);
  const bool partial = is_partial(path);
  const auto writer = writer_of(path);
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
  const Study study(job);
  text +=
      fmt::format("lattice   {} x {} x {} (r1 x r3 x r2), {} designs{}\n", contents.axes[0].size(),
                  contents.axes[1].size(), contents.axes[2].size(), study.designs(),
                  study.scenes() > 1 ? fmt::format(" in {} scenes", study.scenes()) : "");
  Summary summary = to_summary(contents.tally(), study);
  summary.optima = contents.optima;
  summary.complete = contents.complete();
  summary.error = contents.error;
  summary.refined = is_study(job) ? best_refined(job, contents.optima) : contents.refined;
  text += to_text(summary, job);
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

/// The path of an existing archive or partial archive. Throws InputError if neither exists.
fs::path checked_path(const fs::path& given) {
  fs::path path = find(given);
  if (const auto kind = irregular_kind(path))
    throw InputError(fmt::format("{} is {}; give the path of an archive", path.string(), *kind));
  return path;
}

/// Calls `read`, and adds the path to the message of a failure.
template <class F>
auto read_or_explain(const fs::path& path, F read) {
  try {
    return read();
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("{}: {}; not an archive of this format version, or a damaged one",
                    path.string(), error.what()));
  }
}

/// Throws std::runtime_error if an archive cannot be verified now.
void require_verifiable(const fs::path& path) {
  if (const auto writer = writer_of(path))
    throw std::runtime_error(fmt::format("{}: being written by {}; it can be verified afterwards",
                                         path.string(), *writer));
}

/// The damage in the tiles that are done.
std::vector<Damage> find_damage(const fs::path& path, const std::vector<MapInfo>& maps,
                                const Study& study, const Tiling& tiling, std::uint64_t tiles_done,
                                ProgressStyle style) {
  std::vector<Damage> all;
  Progress progress(0, tiles_done, style, "tiles verified");
  const std::uint64_t at_once = tiles_per_verification(maps, tiling);
  for (std::uint64_t first = 0; first < tiles_done; first += at_once) {
    const TileRange tiles{first, std::min(first + at_once, tiles_done)};
    const auto damage = find_damage(path, maps, study, tiling, tiles);
    all.insert(all.end(), damage.begin(), damage.end());
    progress.update(tiles.end);
  }
  return all;
}

/// The part of the lattice, and the scene of a study, that a tile covers.
std::string extent_text(const Tile& tile, const Study& study) {
  const auto& [first, count] = tile.block;
  const auto range = [&](std::size_t d) {
    const double low = study.axes()[d][first[d]], high = study.axes()[d][first[d] + count[d] - 1];
    return low == high ? fmt::format("{}", low) : fmt::format("{} to {}", low, high);
  };
  const std::string scene = outer_values_text(study.job(), tile.scene);
  return fmt::format("{}{}r1 = {}, r3 = {}, r2 = {} m", scene, scene.empty() ? "" : ", ", range(0),
                     range(1), range(2));
}

}  // namespace

std::string describe_archive(const fs::path& given) {
  const fs::path path = checked_path(given);
  return read_or_explain(path, [&] {
    const auto archived = read_archive_header(path);
    return archived && !archived->is_sweep ? describe_assessment(path) : describe_sweep(path);
  });
}

void verify_archive(const fs::path& given, ProgressStyle style, std::FILE* out) {
  const fs::path path = checked_path(given);
  const auto header = read_or_explain(path, [&] { return read_archive_header(path); });
  if (header && !header->is_sweep)
    throw std::runtime_error(
        fmt::format("{}: an assessment, which has no checksums", path.string()));
  const auto contents = read_or_explain(path, [&] { return read_contents(path); });
  require_verifiable(path);
  const Job job = parse_job(contents.job, path, {});
  const Study study(job);
  const auto tiling = read_or_explain(path, [&] { return contents.tiling(study); });
  const auto maps = map_infos(job.output);
  const auto damage = find_damage(path, maps, study, tiling, contents.tiles_done, style);

  fmt::print(out, "archive   {}, {}\n", path.string(), progress_text(path, contents));
  const auto columns = checksum_columns(maps, is_study(job));
  for (const auto& [tile, column] : damage)
    fmt::print(out, "damaged   {}, tile {}: {}\n", columns[column], tile,
               extent_text(tiling.tile(tile), study));
  if (damage.empty() && !contents.complete() && !is_partial(path))
    throw std::runtime_error(fmt::format("{}: damaged: only {} of {} tiles are marked done",
                                         path.string(), contents.tiles_done, contents.tiles));
  if (!damage.empty())
    throw std::runtime_error(fmt::format(
        "{}: damaged; {}repeat the command of the sweep to compute the damaged tiles again",
        path.string(),
        is_partial(path) ? "" : fmt::format("rename it to {} and ", partial_path(path).string())));
  fmt::print(out, "verified  {} of {} tiles: every value of {} is as written\n",
             contents.tiles_done, contents.tiles, fmt::join(columns, ", "));
}

}  // namespace trebsweep
