#include "trebsweep/cli/sweep_estimate.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <ctime>
#include <span>
#include <utility>

#include "trebsweep/archive/free_space.hpp"
#include "trebsweep/archive/output_file.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/job/sample.hpp"
#include "trebsweep/sweep/compute.hpp"
#include "trebsweep/sweep/sweep.hpp"
#include "trebsweep/sweep/unfinished.hpp"
#include "trebsweep/swing/kernel.hpp"

namespace trebsweep {
namespace {

/// What is at the path of an archive, as far as a sweep continues it.
struct Existing {
  bool complete = false;
  Index3 tile_edge{};  // zeros unless a sweep is unfinished
  std::uint64_t designs_done = 0;
};

/// Finds what a sweep would continue. Returns why the sweep would be refused, or nothing. For one
/// rank.
std::string inspect(const Study& study, bool overwrite, Existing& existing) {
  const Job& job = study.job();
  try {
    const OutputFile output = open_or_resume(job, overwrite, Reserve::no);
    existing.complete = output.complete;
    if (output.partial) {
      existing.tile_edge = output.partial->tile_edge;
      existing.designs_done = read_unfinished(partial_path(output.path)).summary.tally.designs();
    } else if (!output.complete) {
      existing.tile_edge = tile_edge(study);
      const auto [archive, journals] = needed_space(study, Tiling(study, existing.tile_edge));
      require_space(job, output.path, archive, archive + journals);
    }
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// Times of a part of a scene's designs, and of its optimum; of the processor.
struct SceneTimes {
  double designs, design_seconds, optima, optimum_seconds;
};

constexpr SceneTimes sum_of(SceneTimes a, const SceneTimes& b) {
  return {a.designs + b.designs, a.design_seconds + b.design_seconds, a.optima + b.optima,
          a.optimum_seconds + b.optimum_seconds};
}

/// Integrates batches of a scene's designs for some time, each rank of a group of four others.
SceneTimes time_scene(const Study& study, std::uint64_t scene, std::size_t batch, double enough,
                      const Refine& refine, MPI_Comm comm) {
  constexpr std::size_t rounds = 4, most_groups = 4;
  const std::size_t groups = std::min(static_cast<std::size_t>(mpi::size(comm)), most_groups);
  const auto designs = sample(study.own_lattice(scene), rounds * groups * batch);
  Compute compute(study);
  Tally tally;
  for (std::size_t round = 0; round < rounds && tally.integration_seconds < enough; ++round) {
    const std::size_t first = round * groups + static_cast<std::size_t>(mpi::rank(comm)) % groups;
    tally.add(compute.timed(scene, every(rounds * groups, first, designs)));
  }
  SceneTimes times{static_cast<double>(tally.designs()), tally.integration_seconds, 1, 0};
  if (tally.best.exists()) {
    const std::clock_t start = std::clock();
    scene_optimum(job_at(study.job(), scene), tally.best, refine);
    times.optimum_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  return times;
}

/// The processor time of all designs and of all optima, s, from up to eight scenes. Collective.
std::pair<double, double> processor_times(const Study& study, const Tiling& tiling,
                                          const Refine& refine, MPI_Comm comm) {
  constexpr std::uint64_t most_scenes = 8;
  constexpr double budget = 1;  // s, of each rank
  const std::uint64_t scenes = std::min(study.scenes(), most_scenes);
  // Lanes are idle at the end of a batch: as many designs as a sweep integrates at once.
  const double of_tile = static_cast<double>(study.designs()) / static_cast<double>(tiling.size());
  const double seconds = mpi::from_root(Compute(study).seconds_per_design(), comm);
  const auto batch =
      static_cast<std::size_t>(std::clamp(std::min(0.2 / seconds, of_tile), 16.0, 4096.0));
  double expected = 0, designs = 0, optimum_seconds = 0, optima = 0;
  for (std::uint64_t s = 0; s < scenes; ++s) {
    const std::uint64_t scene = scenes == 1 ? 0 : s * (study.scenes() - 1) / (scenes - 1);
    SceneTimes times =
        time_scene(study, scene, batch, budget / static_cast<double>(scenes), refine, comm);
    mpi::combine<sum_of>(std::span(&times, 1), comm);
    const auto of_scene = static_cast<double>(study.own_lattice(scene).designs());
    expected += of_scene * times.design_seconds / times.designs;
    designs += of_scene;
    optimum_seconds += times.optimum_seconds;
    optima += times.optima;
  }
  return {expected / designs * static_cast<double>(study.designs()),
          optimum_seconds / optima * static_cast<double>(study.scenes())};
}

/// The largest memory that this process has used so far, bytes.
double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024 * static_cast<double>(usage.ru_maxrss);
}

/// The memory of a rank: what this process has used, and what it has not needed so far: records
/// until they are written, a tile, what all ranks know of tiles and scenes, and the rows of tiles
/// in the archive.
double rank_memory(const Study& study, const Tiling& tiling, double seconds, int ranks) {
  const Output& output = study.job().output;
  constexpr double most_unwritten = 1 << 26;
  const auto tiles = static_cast<double>(tiling.size());
  const auto scenes = static_cast<double>(study.scenes());
  const Block tile{{}, tiling.edge()};
  const double of_tile = static_cast<double>(tile.cells() * 8 * stored_fields(output).size() +
                                             2 * result_bytes(tile, output));
  const double all = static_cast<double>(needed_space(study, tiling).journals) / ranks;
  const double per_second = all / std::max(seconds / ranks, 1.0);
  return peak_memory() + of_tile + std::min(per_second, most_unwritten) +
         scenes * 2 * sizeof(BestDesign) +
         tiles * (24 + 8 * static_cast<double>(6 + status_names.size()));
}

}  // namespace

SweepEstimate estimate(const Study& study, bool overwrite, const Refine& refine, MPI_Comm comm) {
  check_arithmetic(instruction_set(), comm);
  Existing existing;
  const std::string refusal =
      mpi::text_of_root(comm, [&] { return inspect(study, overwrite, existing); });
  existing = mpi::from_root(existing, comm);
  if (existing.tile_edge == Index3{}) existing.tile_edge = mpi::from_root(tile_edge(study), comm);
  const Tiling tiling(study, existing.tile_edge);
  const auto [design_seconds, scene_seconds] = processor_times(study, tiling, refine, comm);
  const double left = existing.complete ? 0
                                        : 1 - static_cast<double>(existing.designs_done) /
                                                  static_cast<double>(study.designs());
  const double memory = rank_memory(study, tiling, design_seconds + scene_seconds, mpi::size(comm));
  return {.designs = study.designs(),
          .scenes = study.scenes(),
          .tiles = tiling.size(),
          .designs_done = existing.designs_done,
          .tile_edge = existing.tile_edge,
          .complete = existing.complete,
          .space = needed_space(study, tiling),
          .rank_bytes = mpi::max(memory, comm),
          .design_seconds = left * design_seconds,
          .scene_seconds = existing.complete ? 0 : scene_seconds,
          .refusal = refusal};
}

}  // namespace trebsweep
