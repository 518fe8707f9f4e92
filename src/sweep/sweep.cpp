#include "trebsweep/sweep/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/message.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/rank_results.hpp"
#include "trebsweep/sweep/schedule.hpp"
#include "trebsweep/sweep/work_queue.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

/// The state of a sweep before its first tile.
struct Start {
  bool complete = false;  ///< the archive of this job already exists
  std::size_t run = 0;    ///< the number of this run of the sweep
  Index3 tile_edge{};
  double design_seconds = 0;  ///< to integrate a design; 0: not measured
};

/// What every stage of a sweep uses.
struct Context {
  const Study& study;
  const Tiling& tiling;
  const SweepOptions& options;
  Start start;
  double start_time;  ///< MPI_Wtime() at the start
  MPI_Comm comm;
};

/// Refuses to mix ranks with and without fused multiply-add: results would depend on the rank that
/// computed them. Collective.
void check_kernels(MPI_Comm comm) {
  const double fused = has_fma(instruction_set()) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with fused multiply-add (FMA) and some on machines without: "
        "their results differ in the last digits; use nodes of one kind");
}

/// Takes the tiles of an unfinished sweep, or chooses those of a new one. For rank 0 only.
void find_tiles(const Study& study, const SweepOptions& options, const OutputFile& output,
                Start& start) {
  if (output.partial) {
    start.tile_edge = output.partial->tile_edge;
    start.run = output.partial->history.size();
  } else if (options.tile_edge) {
    start.tile_edge = *options.tile_edge;
  } else {
    start.design_seconds = seconds_per_design(study, options.stop);
    start.tile_edge =
        tile_edge(study.extent(), study.scenes(), study.job().output.maps, start.design_seconds);
  }
  for (std::size_t d = 0; d < 3; ++d)
    start.tile_edge[d] = std::min(start.tile_edge[d], study.extent()[d]);
}

/// Tells how much disk space a large sweep needs; `archive` is 0 if it is unknown.
void state_space(const SweepOptions& options, std::uintmax_t archive, std::uintmax_t journals) {
  constexpr std::uintmax_t large = 100'000'000;
  if (options.progress == ProgressStyle::none || archive + journals < large) return;
  const std::string least = archive == 0 ? "at least " : "";
  print_message(fmt::format("disk space: {}{} until the archive is complete{}\n", least,
                            size_text(archive + journals),
                            archive == 0 ? "" : ", then " + size_text(archive)));
}

/// Describes a new sweep in its folder, or adds this run to the history of an earlier one. For rank
/// 0.
void open_folder(const Context& context, const OutputFile& output) {
  const Job& job = context.study.job();
  const fs::path folder = partial_path(output.path);
  if (!output.partial) {
    const auto [archive, journals] =
        needed_space(context.study, context.tiling, map_infos(job.output), job.output.compression);
    require_space(job, unfinished_archive(folder), archive, archive + journals);
    state_space(context.options, archive, journals);
    clear_partial(folder);
  }
  PartialSweep sweep =
      output.partial.value_or(PartialSweep{.job = to_text(job),
                                           .source = version_text(),
                                           .kernel = std::string(instruction_set()),
                                           .numerics = numerics_version,
                                           .tile_edge = context.start.tile_edge,
                                           .replaces = output.replaces,
                                           .history = {}});
  const auto ranks = static_cast<std::uint64_t>(mpi::size(context.comm));
  sweep.history.push_back(history_line(context.options.command, ranks));
  write_partial_sweep(folder, sweep);
}

/// The numbers of designs in the first n tiles of a list, n = 0, 1, ...
std::vector<std::uint64_t> cumulated_designs(const Context& context,
                                             const std::vector<std::uint64_t>& tiles) {
  std::vector<std::uint64_t> designs{0};
  for (const std::uint64_t number : tiles) {
    const Tile tile = context.tiling.tile(number);
    designs.push_back(designs.back() + context.study.lattice(tile.scene).designs_in(tile.block));
  }
  return designs;
}

/// Computes the tiles that are to be done, which the ranks share out. Collective; returns whether
/// all are done. Throws mpi::RootError if a journal cannot be written.
bool compute_tiles(const Context& context, RankResults& results) {
  const auto& [study, tiling, options, start, start_time, comm] = context;
  const auto maps = map_infos(study.job().output);
  const auto& to_do = results.tiles_to_do();
  const auto designs = cumulated_designs(context, to_do);
  const std::uint64_t before = study.designs() - designs.back();
  Progress progress(before, study.designs(),
                    mpi::rank(comm) == 0 ? options.progress : ProgressStyle::none);
  const double ranks = mpi::size(comm);
  double counted = start_time;  // the time up to which tallies count
  const auto work = [&, &study = study, &tiling = tiling](
                        const TileRange& range,
                        const std::function<bool()>& poll) -> std::uint64_t {
    std::vector<Tile> tiles;
    for (std::uint64_t n = range.first; n < range.end; ++n) tiles.push_back(tiling.tile(to_do[n]));
    const double begin = MPI_Wtime();
    auto computed = compute(tiles, study, poll);
    const double end = MPI_Wtime();
    const std::uint64_t done = range.first + computed.size();
    const auto all = static_cast<double>(designs[done] - designs[range.first]);
    for (std::size_t i = 0; i < computed.size(); ++i) {
      auto& [values, tally] = computed[i];
      const double share = static_cast<double>(tally.designs()) / all / ranks;
      tally.integration_seconds = share * (end - begin);
      tally.sweep_seconds = share * (end - counted);
      results.add(RecordKind::tile, to_do[range.first + i], to_bytes(tally, values, maps));
    }
    counted = end;
    progress.update(before + designs[done]);
    return computed.size();
  };
  const double tile_seconds = start.design_seconds * static_cast<double>(study.designs()) /
                              static_cast<double>(tiling.size());
  // As many as share_out() wants; a resumed sweep has not measured the time.
  const double first = tile_seconds > 0 ? std::clamp(0.25 / tile_seconds, 1.0, 1e9) : 1;
  const std::uint64_t most = std::max<std::uint64_t>(
      1, (std::uint64_t{64} << 20) / result_bytes({{}, tiling.edge()}, maps));
  const bool all =
      share_out(to_do.size(), static_cast<std::uint64_t>(first), most, work, options.stop, comm);
  results.totals().tally.sweep_seconds += (MPI_Wtime() - counted) / ranks;
  results.combine_tiles(comm);
  return all;
}

/// Finds the optima of the scenes that are to be done, from the best designs of their lattices.
/// Collective; returns whether all are done. Throws as compute_tiles() does, and if the refinement
/// throws.
bool find_optima(const Context& context, RankResults& results) {
  const Job& job = context.study.job();
  const auto& best = results.totals().best;
  auto to_do = results.scenes_to_do();
  std::erase_if(to_do, [&](std::uint64_t scene) { return !best[scene].exists(); });
  const auto work = [&](const TileRange& range, const std::function<bool()>& poll) {
    std::uint64_t n = range.first;
    do {
      const std::uint64_t scene = to_do[n++];
      const BestDesign optimum =
          scene_optimum(job_at(job, scene), best[scene], context.options.refine);
      results.add(RecordKind::scene, scene, to_bytes(optimum));
    } while (n < range.end && !poll());
    return n - range.first;
  };
  constexpr std::uint64_t most = 100'000;
  const bool all = share_out(to_do.size(), 1, most, work, context.options.stop, context.comm);
  results.combine_optima(context.comm);
  return all;
}

/// Writes the archive and gives it its final name; collective.
void write_output(const Context& context, const OutputFile& output, const fs::path& folder,
                  RankResults& results, Summary& summary) {
  const auto& [study, tiling, options, started, start_time, comm] = context;
  const Output& settings = study.job().output;
  const fs::path file = unfinished_archive(folder);
  const double start = MPI_Wtime();
  const auto maps = map_infos(settings);
  std::vector<std::string> history;
  mpi::on_root(comm, [&] { history = read_partial_sweep(folder).history; });
  const Attributes attributes =
      root_attributes(study.job(), fmt::format("{}", fmt::join(history, "\n")), summary);
  const auto own = results.tiles();
  std::uint64_t found = own.size();
  mpi::sum({&found, 1}, comm);
  if (found != tiling.size())
    throw mpi::RootError(
        fmt::format("a journal in {} is damaged; the same command computes again what it held",
                    folder.string()));
  write_archive(file, {study, tiling, maps, settings.compression, attributes, summary.optima}, own,
                comm);
  summary.sweep_seconds += MPI_Wtime() - start;
  mpi::on_root(comm, [&] {
    hdf5::File archive(H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open " + file.string());
    hdf5::write_attribute(archive, "sweep_seconds", summary.sweep_seconds);
    archive.close("write " + file.string());
  });
  mpi::on_all(comm, [&] { sync_file(file); });  // on every host
  mpi::on_root(comm, [&] { finish_output(output); });
}

}  // namespace

std::optional<SweepResult> sweep(const Study& study, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  Start start;
  check_kernels(comm);
  OutputFile output;  // on rank 0 only; holds the lock
  const fs::path folder = mpi::text_of_root(comm, [&] {
    output = open_or_resume(study.job(), options.overwrite);
    start.complete = output.complete;
    if (!start.complete) find_tiles(study, options, output, start);
    return partial_path(output.path).string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;

  const Tiling tiling(study, start.tile_edge);
  const Context context{study, tiling, options, start, start_time, comm};
  mpi::on_root(comm, [&] { open_folder(context, output); });
  try {
    require_visible(folder, comm);
  } catch (const mpi::RootError&) {
    if (mpi::rank(comm) == 0 && start.run == 0) clear_partial(folder);
    throw;
  }

  RankResults results(folder, start.run, start_time, study, tiling, comm);
  bool complete = compute_tiles(context, results) && find_optima(context, results);
  SweepResult result{.summary = results.totals().summary(), .samples = {}};
  if (complete && study.job().solver.check) {
    auto samples = check_scenes(study, results.totals(), options.stop, comm);
    complete = samples.has_value();
    if (samples) result.samples = std::move(*samples);
  }
  result.summary.complete = complete;
  if (complete) {
    result.summary.error = measured_error(result.samples, result.summary.best().value_or(0));
    write_output(context, output, folder, results, result.summary);
  } else {
    mpi::on_all(comm, [&] { results.sync(); });
  }
  return result;
}

}  // namespace trebsweep
