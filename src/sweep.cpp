#include "trebsweep/sweep.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <limits>
#include <numeric>

#include "trebsweep/archive.hpp"
#include "trebsweep/mpi.hpp"
#include "trebsweep/output.hpp"
#include "trebsweep/version.hpp"

namespace trebsweep {
namespace {

/// One map of one tile; values along r2 fastest.
using Map = std::vector<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double outside(Field field) { return field == Field::status ? 0 : nan; }

std::vector<MapInfo> map_infos(const Output& output) {
  const bool has_status = std::count(output.fields.begin(), output.fields.end(), Field::status) > 0;
  std::vector<MapInfo> maps;
  for (const Field field : output.fields) {
    MapInfo map;
    map.dataset = std::string(info(field).name);
    std::replace(map.dataset.begin(), map.dataset.end(), '-', '_');
    map.units = std::string(info(field).units);
    map.long_name = std::string(info(field).meaning);
    map.fill = outside(field);
    if (field == Field::status) {
      map.type = MapType::uint8;
      map.flag_meanings.assign(status_names.begin(), status_names.end());
    } else {
      map.type = output.storage == Storage::float32 ? MapType::float32 : MapType::float64;
      if (has_status) map.ancillary = "status";
    }
    maps.push_back(std::move(map));
  }
  return maps;
}

/// Integrates a tile's designs: a map per field of the job.
template <class Stepper>
std::vector<Map> integrate(const Job& job, const Lattice& lattice, const Tile& tile, Tally& tally) {
  std::vector<Map> maps;
  for (const Field field : job.output.fields) maps.emplace_back(tile.cells(), outside(field));
  const Index3 extent = lattice.extent();
  std::size_t cell = 0;
  for (std::size_t i1 = tile.first[0]; i1 < tile.first[0] + tile.count[0]; ++i1)
    for (std::size_t i3 = tile.first[1]; i3 < tile.first[1] + tile.count[1]; ++i3)
      for (std::size_t i2 = tile.first[2]; i2 < tile.first[2] + tile.count[2]; ++i2, ++cell) {
        if (!lattice.holds({i1, i3, i2})) continue;
        const Design<double> design = lattice.design({i1, i3, i2});
        const Motion<double> motion(job.scene, design);
        const auto outcome = start_is_reachable(job.scene, design.r1)
                                 ? swing<Stepper>(motion, job.solver, Unobserved{})
                                 : Outcome<double>{Status::unreachable_start, {}, 0};
        const bool released = outcome.status == Status::released;
        const double speed = released ? motion.speed(outcome.end.x) : nan;
        for (std::size_t f = 0; f < maps.size(); ++f) switch (job.output.fields[f]) {
            case Field::speed:
              maps[f][cell] = speed;
              break;
            case Field::release_time:
              maps[f][cell] = released ? outcome.end.t : nan;
              break;
            case Field::status:
              maps[f][cell] = static_cast<double>(outcome.status);
              break;
          }
        tally.add(outcome, speed, (i1 * extent[1] + i3) * extent[2] + i2);
      }
  return maps;
}

/// Tiles [first, end), which all ranks compute and then write together, dealt like cards.
struct Round {
  std::uint64_t first, end, rank, ranks;
};

/// The maps of this rank's tiles of a round.
std::vector<std::vector<Map>> integrate(const Round& round, const Job& job, const Lattice& lattice,
                                        const Tiling& tiling, Tally& tally) {
  std::vector<std::vector<Map>> computed;
  for (std::uint64_t t = round.first + round.rank; t < round.end; t += round.ranks)
    computed.push_back(
        with_stepper<double>(job.solver.stepper, [&]<class Stepper>(std::type_identity<Stepper>) {
          return integrate<Stepper>(job, lattice, tiling.tile(t), tally);
        }));
  return computed;
}

/// Writes a round's tiles and marks them done; collective.
void write(const Round& round, const std::vector<std::vector<Map>>& computed, const Tiling& tiling,
           Archive& archive) {
  std::size_t mine = 0;
  for (std::uint64_t t = round.first; t < round.end; t += round.ranks) {
    if (t + round.rank < round.end)
      archive.write(tiling.tile(t + round.rank), computed[mine++]);
    else
      archive.write(std::nullopt, {});
  }
  archive.mark_done(round.first, round.end - round.first);
}

void describe(Archive& archive, const Job& job, const SweepOptions& options, std::uint64_t ranks) {
  const std::time_t now = std::time(nullptr);
  archive.attribute("Conventions", std::string("CF-1.10"));
  archive.attribute("title",
                    "Trebuchet sweep " + std::filesystem::path(job.output.file).stem().string());
  archive.attribute("source", version_text());
  archive.attribute("history", fmt::format("{:%Y-%m-%dT%H:%M:%SZ} {} ({} ranks)", fmt::gmtime(now),
                                           options.command, ranks));
  archive.attribute("format_version", 1ULL);
  archive.attribute("job", to_text(job));
}

void describe(Archive& archive, const Summary& summary) {
  const Optimum none{{nan, nan, nan}, nan, nan};
  const Optimum optimum = summary.optimum.value_or(none);
  archive.attribute("best_speed", optimum.speed);
  archive.attribute("best_r1", optimum.design.r1);
  archive.attribute("best_r3", optimum.design.r3);
  archive.attribute("best_r2", optimum.design.r2);
  archive.attribute("best_release_time", optimum.release_time);
  archive.attribute("designs", static_cast<unsigned long long>(summary.designs()));
  archive.attribute("steps", static_cast<unsigned long long>(summary.steps));
  archive.attribute("integration_seconds", summary.integration_seconds);
  archive.attribute("sweep_seconds", summary.sweep_seconds);
}

/// How many tiles a rank computes before it writes: rounds of about a second, within 64 MiB of
/// maps.
std::uint64_t next_batch(std::uint64_t batch, double round_seconds, std::size_t bytes_per_tile) {
  const double pace = std::clamp(1.0 / std::max(round_seconds, 1e-9), 0.1, 8.0);
  const std::uint64_t most = std::max<std::uint64_t>(1, (std::uint64_t{64} << 20) / bytes_per_tile);
  const auto wanted = static_cast<std::uint64_t>(static_cast<double>(batch) * pace);
  return std::clamp<std::uint64_t>(wanted, 1, most);
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start = MPI_Wtime();
  const Lattice lattice(job.scene, job.lattice);
  const bool to_do = !mpi::on_root(comm, [&] {
                        return prepare_output(job, options.overwrite) ? "to do" : "";
                      }).empty();
  if (!to_do) return std::nullopt;

  Index3 edge = options.tile_edge;
  for (std::size_t d = 0; d < 3; ++d) edge[d] = std::min(edge[d], lattice.extent()[d]);
  const Tiling tiling(lattice, edge);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  Archive archive(job.output.file, lattice, tiling, map_infos(job.output), job.output.compression,
                  comm);
  describe(archive, job, options, ranks);

  Progress progress(lattice.designs(), rank == 0 ? options.progress : ProgressStyle::none);
  const std::size_t bytes_per_tile =
      edge[0] * edge[1] * edge[2] * job.output.fields.size() * sizeof(double);
  Tally tally;
  double integration_seconds = 0;
  std::uint64_t batch = 1;
  for (std::uint64_t next = 0; next < tiling.size();) {
    const Round round{next, std::min(next + batch * ranks, tiling.size()), rank, ranks};
    const double round_start = MPI_Wtime();
    const auto computed = integrate(round, job, lattice, tiling, tally);
    const double round_seconds = MPI_Wtime() - round_start;
    integration_seconds += round_seconds;
    write(round, computed, tiling, archive);
    next = round.end;
    batch = next_batch(batch, mpi::max(round_seconds, comm), bytes_per_tile);
    std::uint64_t done =
        std::accumulate(tally.statuses.begin(), tally.statuses.end(), std::uint64_t{0});
    mpi::sum({&done, 1}, comm);
    progress.update(done);
  }

  Summary summary = combine(tally, lattice, comm);
  summary.integration_seconds = mpi::max(integration_seconds, comm);
  summary.sweep_seconds = mpi::max(MPI_Wtime() - start, comm);
  describe(archive, summary);
  archive.finish();
  return summary;
}

}  // namespace trebsweep
