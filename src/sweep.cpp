#include "trebsweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <queue>
#include <stdexcept>

#include "trebsweep/archive.hpp"
#include "trebsweep/integrate.hpp"
#include "trebsweep/kernel.hpp"
#include "trebsweep/mpi.hpp"
#include "trebsweep/output.hpp"
#include "trebsweep/partial.hpp"
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

/// A tile's maps, one per field of the job, and what they came to.
struct ComputedTile {
  std::vector<Map> maps;
  Tally tally;
};

/// A tile with its number.
struct NumberedTile {
  std::uint64_t number;
  Tile tile;
};

/// How many to take next, for a step of about `wanted` seconds, when the last ones took `seconds`.
std::uint64_t paced(std::uint64_t count, double seconds, double wanted) {
  const double pace = std::clamp(wanted / std::max(seconds, 1e-9), 0.1, 8.0);
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(static_cast<double>(count) * pace));
}

/// Integrates designs, asking now and then whether to stop: slow ones can take minutes per tile.
/// Returns the lanes' steps, or nothing if told to stop.
std::optional<std::uint64_t> integrate(const Job& job, std::span<const Design<double>> designs,
                                       const std::vector<Field>& fields, std::span<Shot> shots,
                                       std::span<double> values,
                                       const std::function<bool()>& stop) {
  std::uint64_t lane_steps = 0, slice = 16;
  for (std::size_t first = 0; first < designs.size();) {
    if (stop()) return std::nullopt;
    const std::size_t count = std::min(slice, designs.size() - first);
    const double start = MPI_Wtime();
    lane_steps += integrate(job.scene, job.solver, designs.subspan(first, count), fields,
                            shots.subspan(first, count),
                            values.subspan(first * fields.size(), count * fields.size()))
                      .lane_steps;
    slice = paced(slice, MPI_Wtime() - start, 0.2);
    first += count;
  }
  return lane_steps;
}

/// Computes some tiles, or nothing if told to stop.
std::optional<std::vector<ComputedTile>> compute(const std::vector<NumberedTile>& tiles,
                                                 const Job& job, const Lattice& lattice,
                                                 const std::function<bool()>& stop) {
  if (stop()) return std::nullopt;
  std::vector<Design<double>> designs;
  for (const auto& [number, tile] : tiles)
    for_each_design(lattice, tile,
                    [&](const Index3& i, std::size_t) { designs.push_back(lattice.design(i)); });
  const std::vector<Field> extra = extra_fields(job.output);
  std::vector<Shot> shots(designs.size());
  std::vector<double> values(designs.size() * extra.size());
  const auto lane_steps = integrate(job, designs, extra, shots, values, stop);
  if (!lane_steps) return std::nullopt;

  const auto place = [&](Field field) {
    return static_cast<std::size_t>(std::find(extra.begin(), extra.end(), field) - extra.begin());
  };
  std::vector<ComputedTile> computed;
  std::size_t n = 0;
  const Index3 extent = lattice.extent();
  for (const auto& [number, tile] : tiles) {
    auto& [maps, tally] = computed.emplace_back();
    for (const Field field : job.output.fields) maps.emplace_back(tile.cells(), outside(field));
    for_each_design(
        lattice, tile, [&, &maps = maps, &tally = tally](const Index3& i, std::size_t cell) {
          const Shot& shot = shots[n];
          const double* const extras = values.data() + n * extra.size();
          for (std::size_t f = 0; f < maps.size(); ++f) {
            const Field field = job.output.fields[f];
            const double value = is_basic(field) ? basic_value(shot, field) : extras[place(field)];
            maps[f][cell] = is_flag(field) && std::isnan(value) ? 0 : value;
          }
          const bool competes =
              job.output.contest == Contest::all || extras[place(Field::slack)] == 1;  // taut
          tally.add(shot, (i[0] * extent[1] + i[1]) * extent[2] + i[2], competes);
          ++n;
        });
  }
  if (!computed.empty()) computed.front().tally.lane_steps = *lane_steps;
  return computed;
}

/// Tiles [first, end), which all ranks compute and then write together, dealt to the ranks: the
/// largest first, each to the rank with the fewest designs so far. All ranks deal alike.
std::vector<std::vector<NumberedTile>> deal(std::uint64_t first, std::uint64_t end,
                                            std::uint64_t ranks, const Lattice& lattice,
                                            const Tiling& tiling) {
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
  std::vector<std::vector<NumberedTile>> dealt(ranks);
  for (const auto& [designs, number] : tiles) {
    const auto [sum, rank] = hands.top();
    hands.pop();
    dealt[rank].push_back({number, tiling.tile(number)});
    hands.push({sum + designs, rank});
  }
  return dealt;
}

/// Writes a round's tiles; collective.
void write(const std::vector<std::vector<NumberedTile>>& dealt, std::uint64_t rank,
           const std::vector<ComputedTile>& computed, Archive& archive) {
  std::size_t most = 0;
  for (const auto& tiles : dealt) most = std::max(most, tiles.size());
  for (std::size_t i = 0; i < most; ++i) {
    if (i < computed.size())
      archive.write(dealt[rank][i].tile, computed[i].maps);
    else
      archive.write(std::nullopt, {});
  }
}

/// The tallies of a round's tiles from `first` on, on rank 0; collective.
std::vector<TallyRow> gather(const std::vector<NumberedTile>& tiles,
                             const std::vector<ComputedTile>& computed, std::uint64_t first,
                             std::uint64_t end, MPI_Comm comm) {
  std::vector<TallyRow> rows(end - first, TallyRow{});
  for (std::size_t i = 0; i < tiles.size(); ++i)
    rows[tiles[i].number - first] = to_row(computed[i].tally);
  mpi::sum_on_root({rows.data()->data(), rows.size() * tally_columns.size()}, comm);
  return rows;
}

/// Refuses ranks whose kernels differ in last digits: a map's would depend on who computed it.
/// Collective.
void check_kernels(MPI_Comm comm) {
  const double fused = fuses(instruction_set()) ? 1 : 0;
  if (mpi::max(fused, comm) + mpi::max(-fused, comm) != 0)
    throw mpi::RootError(
        "some ranks are on machines with the fused multiply-add and some on machines without: "
        "their "
        "results differ in last digits; use nodes of one kind");
}

Attributes attributes(const Summary& summary) {
  const Optimum none{{nan, nan, nan}, nan, nan};
  const Optimum optimum = summary.optimum.value_or(none);
  using Count = unsigned long long;
  return {{"best_speed", optimum.speed},
          {"best_r1", optimum.design.r1},
          {"best_r3", optimum.design.r3},
          {"best_r2", optimum.design.r2},
          {"best_release_time", optimum.release_time},
          {"designs", static_cast<Count>(summary.designs())},
          {"steps", static_cast<Count>(summary.steps)},
          {"lane_utilisation", summary.utilisation()},
          {"integration_seconds", summary.integration_seconds},
          {"sweep_seconds", summary.sweep_seconds}};
}

/// What an archive says of itself from the first; the summary's numbers follow in their places.
Attributes attributes(const Job& job, const std::string& history) {
  Attributes all = attributes(Summary{});
  all.insert(all.end(), {{"format_version", archive_format},
                         {"Conventions", std::string("CF-1.10")},
                         {"title", "Trebuchet sweep " +
                                       std::filesystem::path(job.output.file).stem().string()},
                         {"source", version_text()},
                         {"kernel", std::string(instruction_set())},
                         {"job", to_text(job)},
                         {"history", history}});  // last: when it grows, no other text moves
  return all;
}

/// The extent of a tile: about a fifth of the lattice's, so that there are tiles enough to share
/// and not many more to write.
Index3 tile_edge(const SweepOptions& options, const Lattice& lattice) {
  Index3 edge = lattice.extent();
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t wanted = options.tile_edge.value_or(Index3{})[d];
    const std::size_t most = edge[d] > 2500 ? 64 : 48;
    edge[d] = std::min(edge[d],
                       wanted > 0 ? wanted : std::clamp<std::size_t>((edge[d] + 4) / 5, 16, most));
  }
  return edge;
}

/// How many tiles a rank computes before it writes: rounds of about two seconds, within 64 MiB of
/// maps.
std::uint64_t next_batch(std::uint64_t batch, double round_seconds, std::size_t bytes_per_tile) {
  const std::uint64_t most = std::max<std::uint64_t>(1, (std::uint64_t{64} << 20) / bytes_per_tile);
  return std::min(paced(batch, round_seconds, 2.0), most);
}

/// Where a sweep stands before its first round.
struct Start {
  bool complete = false;        ///< the archive is there already
  Index3 edge{};                ///< of the tiles
  std::uint64_t done = 0;       ///< tiles that earlier runs have done
  std::optional<RunMark> mark;  ///< of the partial file; none where there is none yet
};

/// Finds an archive or a partial file, as rank 0 alone does; `tally` becomes that of what is done.
Start find(const Job& job, const Lattice& lattice, const SweepOptions& options, const Place& place,
           const std::string& history, Tally& tally) {
  Start start{
      .complete = place.complete, .edge = tile_edge(options, lattice), .done = 0, .mark = {}};
  if (!place.begun) return start;
  start.edge = place.begun->tile_edge;
  start.done = place.begun->tiles_done;
  tally = place.begun->tally;
  start.mark = continue_partial(place.path, Tiling(lattice, start.edge), map_infos(job.output),
                                start.done, history);
  return start;
}

/// Makes the partial file; collective. Returns the mark of this run, or nothing if told to stop.
std::optional<RunMark> make(const std::filesystem::path& path, const Job& job,
                            const Lattice& lattice, const Tiling& tiling,
                            const SweepOptions& options, const std::string& history,
                            MPI_Comm comm) {
  const auto all = attributes(job, history);
  const auto maps = map_infos(job.output);
  Progress progress(0, tiling.size(), mpi::rank(comm) == 0 ? options.progress : ProgressStyle::none,
                    "tiles created");
  const auto watch = [&](double share) {
    progress.update(static_cast<std::uint64_t>(share * static_cast<double>(tiling.size())));
    return options.stop();
  };
  return create_partial(path, {lattice, tiling, maps, job.output.compression, all}, watch, comm);
}

}  // namespace

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start_time = MPI_Wtime();
  const Lattice lattice(job.scene, job.lattice);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  // On rank 0 alone: the place with its lock, and what earlier runs have come to.
  Place place;
  Tally tally;
  Start start;
  check_kernels(comm);
  const std::string history = history_line(options.command, ranks);
  const std::filesystem::path path = mpi::text_of_root(comm, [&] {
    place = prepare_output(job, options.overwrite);
    start = find(job, lattice, options, place, history, tally);
    return place.path.string();
  });
  start = mpi::from_root(start, comm);
  if (start.complete) return std::nullopt;
  const Tiling tiling(lattice, start.edge);
  if (!start.mark) start.mark = make(path, job, lattice, tiling, options, history, comm);
  if (!start.mark) {
    Summary summary;
    summary.complete = false;
    summary.begun = false;
    return summary;
  }

  Archive archive(path, map_infos(job.output), comm);

  std::uint64_t designs_done = tally.designs();  // right on rank 0, which tells it
  Progress progress(designs_done, lattice.designs(),
                    rank == 0 ? options.progress : ProgressStyle::none);
  const std::size_t bytes_per_tile =
      start.edge[0] * start.edge[1] * start.edge[2] * job.output.fields.size() * sizeof(double);
  std::uint64_t next = start.done, batch = 1;
  double counted = start_time;  // the seconds until then are in tallies
  while (next < tiling.size()) {
    const std::uint64_t end = std::min(next + batch * ranks, tiling.size());
    const auto dealt = deal(next, end, ranks, lattice, tiling);
    const double round_start = MPI_Wtime();
    auto computed = compute(dealt[rank], job, lattice, options.stop);
    const double round_seconds = mpi::max(MPI_Wtime() - round_start, comm);
    const bool all_computed = mpi::max(computed ? 0 : 1, comm) == 0;
    if (!all_computed) break;

    if (rank == 0) check_mark(*start.mark, partial_path(path));
    write(dealt, rank, *computed, archive);
    for (std::size_t i = 0; i < computed->size(); ++i) {
      ComputedTile& tile = (*computed)[i];
      if (dealt[rank][i].number == next) {
        tile.tally.integration_seconds = round_seconds;
        tile.tally.sweep_seconds = MPI_Wtime() - counted;
      }
      tally.add(tile.tally);
    }
    counted = MPI_Wtime();
    archive.mark_done(next, gather(dealt[rank], *computed, next, end, comm));
    for (; next < end; ++next) designs_done += lattice.designs_in(tiling.tile(next));
    batch = next_batch(batch, round_seconds, bytes_per_tile);
    progress.update(designs_done);
  }

  if (rank == 0) tally.sweep_seconds += MPI_Wtime() - counted;
  Summary summary = combine(tally, lattice, comm);
  summary.complete = next == tiling.size();
  if (summary.complete) archive.write(attributes(summary));
  archive.close();
  if (summary.complete) mpi::on_root(comm, [&] { finish(path, *start.mark, place.replaces); });
  return summary;
}

}  // namespace trebsweep
