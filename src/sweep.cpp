#include "trebsweep/sweep.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <iterator>
#include <limits>
#include <numeric>
#include <queue>
#include <stdexcept>

#include "trebsweep/archive.hpp"
#include "trebsweep/integrate.hpp"
#include "trebsweep/mpi.hpp"
#include "trebsweep/output.hpp"
#include "trebsweep/version.hpp"

namespace trebsweep {
namespace {

/// One map of one tile; values along r2 fastest.
using Map = std::vector<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

double outside(Field field) { return is_flag(field) ? 0 : nan; }

/// The names of a flag field's values 0, 1, ...
std::vector<std::string> flag_meanings(Field field) {
  if (field == Field::status) return {status_names.begin(), status_names.end()};
  if (field == Field::slack) return {slack_names.begin(), slack_names.end()};
  return {};
}

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
    map.flag_meanings = flag_meanings(field);
    if (is_flag(field))
      map.type = MapType::uint8;
    else
      map.type = output.storage == Storage::float32 ? MapType::float32 : MapType::float64;
    if (field != Field::status && has_status) map.ancillary = "status";
    maps.push_back(std::move(map));
  }
  return maps;
}

/// Calls f(i, cell) for each design of a tile: its place in the lattice, and in the tile's maps.
template <class F>
void for_each_design(const Lattice& lattice, const Tile& tile, F f) {
  std::size_t cell = 0;
  for (std::size_t i1 = tile.first[0]; i1 < tile.first[0] + tile.count[0]; ++i1)
    for (std::size_t i3 = tile.first[1]; i3 < tile.first[1] + tile.count[1]; ++i3)
      for (std::size_t i2 = tile.first[2]; i2 < tile.first[2] + tile.count[2]; ++i2, ++cell)
        if (lattice.holds({i1, i3, i2})) f(Index3{i1, i3, i2}, cell);
}

double basic_value(const Shot& shot, Field field) {
  switch (field) {
    case Field::speed:
      return shot.speed;
    case Field::release_time:
      return shot.release_time;
    case Field::status:
      return static_cast<double>(shot.status);
    case Field::steps:
      return static_cast<double>(shot.steps);
    default:
      throw std::logic_error("not a field of every shot");
  }
}

/// The fields beyond those of every shot that a job's maps, or its choice of the optimum, need.
std::vector<Field> extra_fields(const Output& output) {
  std::vector<Field> extra;
  std::copy_if(output.fields.begin(), output.fields.end(), std::back_inserter(extra),
               [](Field field) { return !is_basic(field); });
  if (output.contest == Contest::taut && std::count(extra.begin(), extra.end(), Field::slack) == 0)
    extra.push_back(Field::slack);
  return extra;
}

/// The maps of some tiles, a map per field of the job for each.
std::vector<std::vector<Map>> integrate(const std::vector<Tile>& tiles, const Job& job,
                                        const Lattice& lattice, Tally& tally) {
  // All at once: lanes run dry at the end only.
  std::vector<Design<double>> designs;
  for (const Tile& tile : tiles)
    for_each_design(lattice, tile,
                    [&](const Index3& i, std::size_t) { designs.push_back(lattice.design(i)); });
  const std::vector<Field> extra = extra_fields(job.output);
  std::vector<Shot> shots(designs.size());
  std::vector<double> values(designs.size() * extra.size());
  tally.lane_steps += integrate(job.scene, job.solver, designs, extra, shots, values).lane_steps;

  const auto place = [&](Field field) {
    return static_cast<std::size_t>(std::find(extra.begin(), extra.end(), field) - extra.begin());
  };
  std::vector<std::size_t> places;  // of the job's fields among the extra ones
  for (const Field field : job.output.fields) places.push_back(place(field));
  const std::size_t slack = place(Field::slack);
  std::vector<std::vector<Map>> computed;
  std::size_t n = 0;
  const Index3 extent = lattice.extent();
  for (const Tile& tile : tiles) {
    std::vector<Map>& maps = computed.emplace_back();
    for (const Field field : job.output.fields) maps.emplace_back(tile.cells(), outside(field));
    for_each_design(lattice, tile, [&](const Index3& i, std::size_t cell) {
      const Shot& shot = shots[n];
      const double* const extras = values.data() + n * extra.size();
      for (std::size_t f = 0; f < maps.size(); ++f) {
        const Field field = job.output.fields[f];
        const double value = is_basic(field) ? basic_value(shot, field) : extras[places[f]];
        maps[f][cell] = is_flag(field) && std::isnan(value) ? 0 : value;
      }
      const bool competes = job.output.contest == Contest::all || extras[slack] == 1;  // taut
      tally.add(shot, (i[0] * extent[1] + i[1]) * extent[2] + i[2], competes);
      ++n;
    });
  }
  return computed;
}

/// Tiles [first, end), which all ranks compute and then write together, dealt to the ranks: the
/// largest first, each to the rank with the fewest designs so far. All ranks deal alike.
std::vector<std::vector<Tile>> deal(std::uint64_t first, std::uint64_t end, std::uint64_t ranks,
                                    const Lattice& lattice, const Tiling& tiling) {
  struct Sized {
    std::uint64_t designs, number;
  };
  std::vector<Sized> tiles;
  for (std::uint64_t t = first; t < end; ++t)
    tiles.push_back({lattice.designs_in(tiling.tile(t)), t});
  std::stable_sort(tiles.begin(), tiles.end(),
                   [](const Sized& a, const Sized& b) { return a.designs > b.designs; });

  using Hand = std::pair<std::uint64_t, std::uint64_t>;  // designs, rank
  std::priority_queue<Hand, std::vector<Hand>, std::greater<>> hands;
  for (std::uint64_t rank = 0; rank < ranks; ++rank) hands.push({0, rank});
  std::vector<std::vector<Tile>> dealt(ranks);
  for (const auto& [designs, number] : tiles) {
    const auto [sum, rank] = hands.top();
    hands.pop();
    dealt[rank].push_back(tiling.tile(number));
    hands.push({sum + designs, rank});
  }
  return dealt;
}

/// Writes a round's tiles; collective.
void write(const std::vector<std::vector<Tile>>& dealt, std::uint64_t rank,
           const std::vector<std::vector<Map>>& computed, Archive& archive) {
  std::size_t most = 0;
  for (const auto& tiles : dealt) most = std::max(most, tiles.size());
  for (std::size_t i = 0; i < most; ++i) {
    if (i < dealt[rank].size())
      archive.write(dealt[rank][i], computed[i]);
    else
      archive.write(std::nullopt, {});
  }
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
  archive.attribute("lane_utilisation", summary.utilisation());
  archive.attribute("integration_seconds", summary.integration_seconds);
  archive.attribute("sweep_seconds", summary.sweep_seconds);
}

/// The extent of a tile: about a fifth of the lattice's, so that there are tiles enough to share
/// and not many more to write.
Index3 tile_edge(const SweepOptions& options, const Lattice& lattice) {
  Index3 edge = lattice.extent();
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t wanted = options.tile_edge.value_or(Index3{})[d];
    edge[d] =
        std::min(edge[d], wanted > 0 ? wanted : std::clamp<std::size_t>((edge[d] + 4) / 5, 16, 64));
  }
  return edge;
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

  const Index3 edge = tile_edge(options, lattice);
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
    const std::uint64_t end = std::min(next + batch * ranks, tiling.size());
    const auto dealt = deal(next, end, ranks, lattice, tiling);
    const double round_start = MPI_Wtime();
    const auto computed = integrate(dealt[rank], job, lattice, tally);
    const double round_seconds = MPI_Wtime() - round_start;
    integration_seconds += round_seconds;
    write(dealt, rank, computed, archive);
    archive.mark_done(next, end - next);
    next = end;
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
