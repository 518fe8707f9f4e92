#include "trebsweep/cli/info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <boost/interprocess/anonymous_shared_memory.hpp>
#include <functional>
#include <span>
#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/archive_reader.hpp"
#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/archive/verify.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/cli/child_process.hpp"
#include "trebsweep/cli/json_summary.hpp"
#include "trebsweep/cli/sweep_report.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/sweep/unfinished.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

bool is_partial(const fs::path& path) { return path.extension() == ".partial"; }

using Json = nlohmann::ordered_json;

/// The lines of a history.
std::vector<std::string> lines_of(const std::string& history) {
  std::vector<std::string> lines;
  boost::split(lines, history, boost::is_any_of("\n"));
  return lines;
}

std::string describe_assessment(const fs::path& path, const ArchiveHeader& header, bool json) {
  if (json)
    return Json{{"archive", path.string()},
                {"tables", header.tables},
                {"source", header.source},
                {"history", lines_of(header.history)},
                {"job", header.job}}
               .dump(2) +
           "\n";
  return fmt::format("archive   {}, an assessment\ntables    {}\nsource    {}\nhistory   {}\n\n{}",
                     path.string(), fmt::join(header.tables, ", "), header.source,
                     boost::replace_all_copy(header.history, "\n", "\n          "), header.job);
}

/// The share of the tiles that are done.
std::string share_text(std::uint64_t done, std::uint64_t tiles) {
  return fmt::format("{:.1f} % of the tiles done",
                     100 * static_cast<double>(done) / static_cast<double>(tiles));
}

/// A sweep, and what is said of it before and after its summary.
struct DescribedSweep {
  std::string progress, scene, source, history, job;
  std::uint64_t tiles, tiles_done;
  Index3 tile_edge, extent;
  std::uint64_t designs;  ///< of all scenes; 0 if unknown
  Summary summary;
};

std::string lattice_text(const DescribedSweep& sweep) {
  const std::size_t scenes = sweep.summary.optima.size();
  std::string text = fmt::format("{} (r1 x r3 x r2)", fmt::join(sweep.extent, " x "));
  if (sweep.designs > 0) text += fmt::format(", {} designs", sweep.designs);
  return scenes > 1 ? fmt::format("{} in {} scenes", text, scenes) : text;
}

std::string describe(const fs::path& path, const DescribedSweep& sweep) {
  const Job job = parse_job(sweep.job, path, {});
  std::string text = fmt::format("archive   {}, {}\n", path.string(), sweep.progress);
  text += fmt::format("scene     {}\nsolver    {}\n", sweep.scene, solver_text(job.solver));
  text += fmt::format("tiles     {} of {} done, of {} designs (r1 x r3 x r2)\n", sweep.tiles_done,
                      sweep.tiles, fmt::join(sweep.tile_edge, " x "));
  text += fmt::format("lattice   {}\n", lattice_text(sweep));
  return text + to_text(sweep.summary, job) +
         fmt::format("\nsource    {}\nhistory   {}\n\n{}", sweep.source,
                     boost::replace_all_copy(sweep.history, "\n", "\n          "), sweep.job);
}

std::string to_json(const fs::path& path, const DescribedSweep& sweep) {
  Json json{{"archive", path.string()},          {"tiles", sweep.tiles},
            {"tiles_done", sweep.tiles_done},    {"tile", sweep.tile_edge},
            {"lattice", sweep.extent},           {"source", sweep.source},
            {"history", lines_of(sweep.history)}};
  json.update(to_json(sweep.summary, parse_job(sweep.job, path, {})));
  return json.dump(2) + "\n";
}

DescribedSweep unfinished(const fs::path& folder) {
  const Unfinished sweep = read_unfinished(folder);
  const auto& [description, study, tiling, journals, tiles, summary] = sweep;
  const auto writer = lock_holder(folder);
  return {.progress = fmt::format("unfinished, {}; {}", share_text(tiles.size(), tiling.size()),
                                  writer ? "being written by " + *writer
                                         : "interrupted: run the command of the sweep again to "
                                           "continue it"),
          .scene = scene_text(study.job()),
          .source = fmt::format("{}, {}", description.source, description.kernel),
          .history = fmt::format("{}", fmt::join(description.history, "\n")),
          .job = description.job,
          .tiles = tiling.size(),
          .tiles_done = tiles.size(),
          .tile_edge = tiling.edge(),
          .extent = study.extent(),
          .designs = study.designs(),
          .summary = summary};
}

/// The progress of an archive.
std::string progress_text(const ArchiveContents& contents) {
  return contents.summary.complete ? "complete"
                                   : "a snapshot of an unfinished sweep, " +
                                         share_text(contents.tiles_done, contents.tiles.size());
}

DescribedSweep archived(const fs::path& path) {
  const ArchiveContents contents = read_contents(path);
  const Summary& summary = contents.summary;
  const auto& [r1, r3, r2] = contents.axes;
  Index3 edge{};
  for (const Tile& tile : contents.tiles)
    for (std::size_t d = 0; d < 3; ++d) edge[d] = std::max(edge[d], tile.block.count[d]);
  return {.progress = progress_text(contents),
          .scene = contents.scene,
          .source = fmt::format("{}, {}", contents.header.source, contents.kernel),
          .history = contents.header.history,
          .job = contents.header.job,
          .tiles = contents.tiles.size(),
          .tiles_done = contents.tiles_done,
          .tile_edge = edge,
          .extent = {r1.size(), r3.size(), r2.size()},
          .designs = summary.complete ? summary.tally.designs() : 0,
          .summary = summary};
}

/// The path itself if it exists, otherwise that of its partial sweep.
fs::path find(fs::path given) {
  if (!given.has_filename()) given = given.parent_path();  // a folder, with a slash at its end
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

constexpr unsigned cpu_seconds = 10, wall_seconds = 60;  // a file system may be slow

/// Whether `read` completes in a child process: HDF5 crashes on some damaged files, and hangs on
/// others. Throws std::system_error, which names the path, if that cannot be decided.
bool completes(const fs::path& path, const std::function<void()>& read) {
  try {
    return completes_in_child(read, cpu_seconds, wall_seconds);
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "cannot read " + path.string());
  }
}

/// Calls `read`, of an archive first in a child process. Adds the path to the message of a failure.
template <class F>
auto read_or_explain(const fs::path& path, F read) {
  const auto fail = [&](const std::string& why) {
    throw std::runtime_error(fmt::format(
        "{}: {}; not an archive of this format version, or a damaged one", path.string(), why));
  };
  if (!is_partial_sweep(path) && !completes(path, [&] { read(); }))
    fail("damaged: HDF5 cannot read it");
  try {
    return read();
  } catch (const std::runtime_error& error) {
    fail(error.what());
    throw;
  }
}

/// A part of a tile whose bytes do not match their checksum, or cannot be read.
struct Damage {
  std::uint64_t tile;
  std::size_t map;  ///< of ArchiveContents::maps
};

/// Verifies tiles in a child process: what it has not reached when HDF5 crashes or hangs is
/// damaged.
std::vector<Damage> find_damage(const fs::path& path, const ArchiveContents& contents,
                                const TileRange& tiles) {
  const std::size_t maps = contents.maps.size(), flags = (tiles.end - tiles.first) * maps;
  if (flags == 0) return {};
  const auto shared = boost::interprocess::anonymous_shared_memory(flags * sizeof(bool));
  const std::span<bool> intact(static_cast<bool*>(shared.get_address()), flags);
  completes(path, [&] { verify(path, contents, tiles, intact); });
  std::vector<Damage> damage;
  for (std::size_t i = 0; i < flags; ++i)
    if (!intact[i]) damage.push_back({tiles.first + i / maps, i % maps});
  return damage;
}

std::vector<Damage> find_damage(const fs::path& path, const ArchiveContents& contents,
                                ProgressStyle style) {
  std::vector<Damage> all;
  const std::uint64_t size = contents.tiles.size(), at_once = tiles_per_verification(contents);
  Progress progress(0, size, style, "tiles verified");
  for (std::uint64_t first = 0; first < size; first += at_once) {
    const TileRange tiles{first, std::min(first + at_once, size)};
    const auto damage = find_damage(path, contents, tiles);
    all.insert(all.end(), damage.begin(), damage.end());
    progress.update(tiles.end);
  }
  return all;
}

/// The part of the lattice, and the scene of a study, that a tile covers.
std::string extent_text(const Tile& tile, const ArchiveContents& contents, const Job& job) {
  const Block& block = tile.block;
  const auto range = [&](std::size_t d) {
    const double low = contents.axes[d][block.first[d]],
                 high = contents.axes[d][block.first[d] + block.count[d] - 1];
    return low == high ? fmt::format("{}", low) : fmt::format("{} to {}", low, high);
  };
  const std::string scene = outer_values_text(job, tile.scene);
  return fmt::format("{}{}r1 = {}, r3 = {}, r2 = {} m", scene, scene.empty() ? "" : ", ", range(0),
                     range(1), range(2));
}

}  // namespace

std::string describe_archive(const fs::path& given, bool json) {
  const fs::path path = checked_path(given);
  return read_or_explain(path, [&] {
    const bool partial = is_partial_sweep(path);
    if (!partial)
      if (const ArchiveHeader header = read_header(path); !header.is_sweep())
        return describe_assessment(path, header, json);
    const DescribedSweep sweep = partial ? unfinished(path) : archived(path);
    return json ? to_json(path, sweep) : describe(path, sweep);
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
  const auto sweep = read_or_explain(path, [&] { return read_unfinished(path); });
  const fs::path temporary = output.string() + ".new";
  try {
    write_snapshot(temporary, sweep);
    fs::rename(temporary, output);
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw std::runtime_error(fmt::format("--snapshot {}: {}", output.string(), error.what()));
  }
}

void verify_archive(const fs::path& given, ProgressStyle style, std::FILE* out) {
  const fs::path path = checked_path(given);
  if (is_partial_sweep(path))
    throw InputError(
        fmt::format("{}: an unfinished sweep; it is verified when it is continued", path.string()));
  if (!read_or_explain(path, [&] { return read_header(path); }).is_sweep())
    throw InputError(fmt::format("{}: an assessment, which has no checksums", path.string()));
  const auto contents = read_or_explain(path, [&] { return read_contents(path); });
  if (!contents.summary.complete)
    throw InputError(fmt::format("{}: {}; only complete archives are verified", path.string(),
                                 progress_text(contents)));
  const auto damage = find_damage(path, contents, style);

  fmt::print(out, "archive   {}, {}\n", path.string(), progress_text(contents));
  const Job job = parse_job(contents.header.job, path, {});
  for (const auto& [tile, map] : damage)
    fmt::print(out, "damaged   {}, tile {}: {}\n", contents.maps[map], tile,
               extent_text(contents.tiles[tile], contents, job));
  if (!damage.empty())
    throw std::runtime_error(
        fmt::format("{}: damaged; compute it again: repeat the command of the sweep with "
                    "--overwrite",
                    path.string()));
  fmt::print(out, "verified  {} tiles: every value{}{} is as written\n", contents.tiles.size(),
             contents.maps.empty() ? "" : " of ", fmt::join(contents.maps, ", "));
}

}  // namespace trebsweep
