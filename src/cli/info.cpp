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
#include "trebsweep/archive/untrusted_file.hpp"
#include "trebsweep/archive/verify.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"
#include "trebsweep/sweep/unfinished.hpp"

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

std::string describe_assessment(const fs::path& path) {
  const AssessmentContents contents = read_assessment(path);
  return fmt::format("archive   {}, an assessment\ntables    {}\nsource    {}\nhistory   {}\n\n{}",
                     path.string(), fmt::join(contents.tables, ", "), contents.source,
                     boost::replace_all_copy(contents.history, "\n", "\n          "), contents.job);
}

/// The share of the tiles that are done.
std::string share_text(std::uint64_t done, std::uint64_t tiles) {
  return fmt::format("{:.1f} % of the tiles done",
                     100 * static_cast<double>(done) / static_cast<double>(tiles));
}

/// What is said of a sweep before and after its summary.
struct SweepText {
  std::string progress, scene, source, history, job;
  std::uint64_t tiles, tiles_done;
  Index3 tile_edge;
};

std::string describe(const fs::path& path, const SweepText& sweep, const Study& study,
                     const Summary& summary) {
  const Job& job = study.job();
  std::string text = fmt::format("archive   {}, {}\n", path.string(), sweep.progress);
  text += fmt::format("scene     {}\nsolver    {}\n", sweep.scene, solver_text(job.solver));
  text += fmt::format("tiles     {} of {} done, of {} designs (r1 x r3 x r2)\n", sweep.tiles_done,
                      sweep.tiles, fmt::join(sweep.tile_edge, " x "));
  text += fmt::format("lattice   {} (r1 x r3 x r2), {} designs{}\n",
                      fmt::join(study.extent(), " x "), study.designs(),
                      study.scenes() > 1 ? fmt::format(" in {} scenes", study.scenes()) : "");
  return text + to_text(summary, job) +
         fmt::format("\nsource    {}\nhistory   {}\n\n{}", sweep.source,
                     boost::replace_all_copy(sweep.history, "\n", "\n          "), sweep.job);
}

std::string describe_unfinished(const fs::path& folder) {
  const Unfinished sweep(folder);
  const auto& [job, source, kernel, numerics, edge, replaces, history] = sweep.description();
  const auto writer = writer_of(folder);
  const std::string share = share_text(sweep.tiles_done(), sweep.tiling().size());
  return describe(
      folder,
      {.progress = fmt::format("unfinished, {}; {}", share,
                               writer ? "being written by " + *writer
                                      : "interrupted: run the command of the sweep again to "
                                        "continue it"),
       .scene = scene_text(sweep.study().job()),
       .source = fmt::format("{}, {}", source, kernel),
       .history = fmt::format("{}", fmt::join(history, "\n")),
       .job = job,
       .tiles = sweep.tiling().size(),
       .tiles_done = sweep.tiles_done(),
       .tile_edge = edge},
      sweep.study(), sweep.summary());
}

/// The progress of an archive.
std::string progress_text(const ArchiveContents& contents) {
  return contents.complete() ? "complete"
                             : "a snapshot of an unfinished sweep, " +
                                   share_text(contents.tiles_done, contents.tiles);
}

std::string describe_sweep(const fs::path& path) {
  const ArchiveContents contents = read_contents(path);
  const Job job = parse_job(contents.job, path, {});
  const Study study(job);
  Summary summary = to_summary(contents.tally(), study);
  summary.optima = contents.optima;
  summary.complete = contents.complete();
  summary.error = contents.error;
  summary.refined = is_study(job) ? best_refined(job, contents.optima) : contents.refined;
  return describe(path,
                  {.progress = progress_text(contents),
                   .scene = contents.scene,
                   .source = fmt::format("{}, {}", contents.source, contents.kernel),
                   .history = contents.history,
                   .job = contents.job,
                   .tiles = contents.tiles,
                   .tiles_done = contents.tiles_done,
                   .tile_edge = contents.tile_edge},
                  study, summary);
}

/// The path itself if it exists, otherwise that of its partial sweep.
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

bool is_partial_sweep(const fs::path& path) { return fs::is_directory(path) && is_partial(path); }

/// The path of an existing archive or partial sweep. Throws InputError if neither exists.
fs::path checked_path(const fs::path& given) {
  fs::path path = find(given);
  if (is_partial_sweep(path)) return path;
  if (const auto kind = irregular_kind(path))
    throw InputError(fmt::format("{} is {}; give the path of an archive", path.string(), *kind));
  return path;
}

/// Calls `read`, of an archive first in a child process, since HDF5 crashes on some damaged files.
/// Adds the path to the message of a failure.
template <class F>
auto read_or_explain(const fs::path& path, F read) {
  try {
    return is_partial_sweep(path) ? read() : untrusted::read(path, read);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(
        fmt::format("{}: {}; not an archive of this format version, or a damaged one",
                    path.string(), error.what()));
  }
}

/// The damage in the tiles that are done.
std::vector<Damage> find_damage(const fs::path& path, const std::vector<MapInfo>& maps,
                                const Study& study, const Tiling& tiling, ProgressStyle style) {
  std::vector<Damage> all;
  Progress progress(0, tiling.size(), style, "tiles verified");
  const std::uint64_t at_once = tiles_per_verification(maps, tiling);
  for (std::uint64_t first = 0; first < tiling.size(); first += at_once) {
    const TileRange tiles{first, std::min(first + at_once, tiling.size())};
    const auto damage = find_damage(path, maps, study, tiling, tiles);
    all.insert(all.end(), damage.begin(), damage.end());
    progress.update(tiles.end);
  }
  return all;
}

/// The part of the lattice, and the scene of a study, that a tile covers.
std::string extent_text(const Tile& tile, const Study& study) {
  const Block& block = tile.block;
  const auto range = [&](std::size_t d) {
    const double low = study.axes()[d][block.first[d]],
                 high = study.axes()[d][block.first[d] + block.count[d] - 1];
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
    if (is_partial_sweep(path)) return describe_unfinished(path);
    const auto archived = read_archive_header(path);
    return archived && !archived->is_sweep ? describe_assessment(path) : describe_sweep(path);
  });
}

void write_snapshot(const fs::path& given, const fs::path& output) {
  const fs::path path = checked_path(given);
  if (!is_partial_sweep(path))
    throw InputError(
        fmt::format("{}: not an unfinished sweep; give the path of a folder "
                    "FILE.partial",
                    path.string()));
  if (fs::exists(fs::symlink_status(output)))
    throw InputError(
        fmt::format("--snapshot {}: exists; name another file", shortened(output.string())));
  read_or_explain(path, [&] { return Unfinished(path).write_snapshot(output), true; });
}

void verify_archive(const fs::path& given, ProgressStyle style, std::FILE* out) {
  const fs::path path = checked_path(given);
  if (is_partial_sweep(path))
    throw InputError(
        fmt::format("{}: an unfinished sweep; it is verified when it is continued", path.string()));
  const auto header = read_or_explain(path, [&] { return read_archive_header(path); });
  if (header && !header->is_sweep)
    throw std::runtime_error(
        fmt::format("{}: an assessment, which has no checksums", path.string()));
  const auto contents = read_or_explain(path, [&] { return read_contents(path); });
  if (!contents.complete())
    throw std::runtime_error(fmt::format("{}: {}; only complete archives are verified",
                                         path.string(), progress_text(contents)));
  const Job job = parse_job(contents.job, path, {});
  const Study study(job);
  const auto tiling = read_or_explain(path, [&] { return contents.tiling(study); });
  const auto maps = map_infos(job.output);
  const auto damage = find_damage(path, maps, study, tiling, style);

  fmt::print(out, "archive   {}, {}\n", path.string(), progress_text(contents));
  const auto columns = checksum_columns(maps, is_study(job));
  for (const auto& [tile, column] : damage)
    fmt::print(out, "damaged   {}, tile {}: {}\n", columns[column], tile,
               extent_text(tiling.tile(tile), study));
  if (!damage.empty())
    throw std::runtime_error(
        fmt::format("{}: damaged; compute it again: repeat the command of the sweep with "
                    "--overwrite",
                    path.string()));
  fmt::print(out, "verified  {} tiles: every value of {} is as written\n", contents.tiles,
             fmt::join(columns, ", "));
}

}  // namespace trebsweep
