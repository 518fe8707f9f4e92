#include "trebsweep/sweep.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>

#include "trebsweep/archive.hpp"
#include "trebsweep/error.hpp"
#include "trebsweep/mpi.hpp"
#include "trebsweep/version.hpp"

namespace trebsweep {
namespace {

/// One map of one tile; values along r2 fastest.
using Map = std::vector<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr auto no_index = std::numeric_limits<std::uint64_t>::max();

/// What one rank has seen so far.
struct Tally {
  std::array<std::uint64_t, status_names.size()> statuses{};
  std::uint64_t steps = 0;
  double best_speed = -1;
  double best_time = nan;
  std::uint64_t best_index = no_index;  // of the cell in the box; decides between equal speeds

  void add(Status status, std::uint64_t swing_steps, double speed, double time,
           std::uint64_t index) {
    ++statuses[static_cast<std::size_t>(status)];
    steps += swing_steps;
    if (status != Status::released) return;
    if (speed > best_speed || (speed == best_speed && index < best_index)) {
      best_speed = speed;
      best_time = time;
      best_index = index;
    }
  }
};

double outside(Field field) { return field == Field::status ? 0 : nan; }

/// The value of a field for a design that was integrated.
double value_of(Field field, const Motion<double>& motion, const Outcome<double>& outcome) {
  if (field == Field::status) return static_cast<double>(outcome.status);
  if (outcome.status != Status::released) return nan;
  return field == Field::speed ? motion.speed(outcome.end.x) : outcome.end.t;
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
  const std::vector<Field>& fields = job.output.fields;
  std::vector<Map> maps;
  for (const Field field : fields) maps.emplace_back(tile.cells(), outside(field));
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
        for (std::size_t f = 0; f < fields.size(); ++f)
          maps[f][cell] = value_of(fields[f], motion, outcome);
        tally.add(outcome.status, outcome.steps, value_of(Field::speed, motion, outcome),
                  outcome.end.t, (i1 * extent[1] + i3) * extent[2] + i2);
      }
  return maps;
}

/// Whether two jobs make the same maps in the same form, wherever they go.
bool same_job(Job a, const std::string& archived) {
  try {
    const Job b = parse_job(archived, "archived", {});
    a.output.file = b.output.file;
    return to_text(a) == to_text(b);
  } catch (const InputError&) {
    return false;  // made by a version with other keys
  }
}

/// Makes sure, on rank 0 and before anything is computed, that the archive can be written. Returns
/// whether it is there already, complete.
bool prepare_output(const Job& job, bool overwrite) {
  namespace fs = std::filesystem;
  const fs::path path = job.output.file;
  const fs::path partial = Archive::partial_path(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto refuse_file = [&](const std::string& why) {
    throw InputError(fmt::format("output.file = {}: {}", path.string(), why));
  };
  std::error_code unknown;  // what cannot be asked about cannot be written either: open() tells why
  if (!fs::is_directory(folder, unknown))
    refuse_file(fmt::format("{} is no folder; make it, or name another", folder.string()));
  if (fs::is_directory(path, unknown)) refuse_file("is a folder; name a file");
  if (fs::exists(path, unknown)) {
    const auto archived = archived_job(path);
    if (!archived) refuse_file("is there already and is no archive of a sweep; name another file");
    if (!overwrite && same_job(job, *archived)) return true;
    if (!overwrite)
      refuse_file(
          "holds the archive of another job; name another file, or replace it with --overwrite");
  }
  const int file = open(partial.c_str(), O_WRONLY | O_CREAT | (overwrite ? 0 : O_EXCL), 0666);
  if (file < 0 && errno == EEXIST)
    refuse_file(
        fmt::format("{} holds an unfinished sweep; name another file, or start anew with "
                    "--overwrite",
                    partial.string()));
  if (file < 0)
    refuse_file(fmt::format("cannot write in {}: {}", folder.string(), std::strerror(errno)));
  close(file);
  return false;
}

/// The sum of what all ranks have seen.
Summary combine(const Tally& tally, const Lattice& lattice, MPI_Comm comm) {
  Summary summary;
  summary.statuses = tally.statuses;
  mpi::sum(summary.statuses, comm);
  summary.steps = tally.steps;
  mpi::sum({&summary.steps, 1}, comm);

  const double speed = mpi::max(tally.best_speed, comm);
  const std::uint64_t index =
      mpi::min(tally.best_speed == speed ? tally.best_index : no_index, comm);
  if (index == no_index) return summary;
  const double time = mpi::max(tally.best_index == index ? tally.best_time : -1, comm);
  const Index3 extent = lattice.extent();
  const Index3 place{index / (extent[1] * extent[2]), index / extent[2] % extent[1],
                     index % extent[2]};
  summary.optimum = {lattice.design(place), speed, time};
  return summary;
}

void describe(Archive& archive, const Job& job, const SweepOptions& options, int ranks) {
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

std::uint64_t Summary::designs() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

std::optional<Summary> sweep(const Job& job, const SweepOptions& options, MPI_Comm comm) {
  const double start = MPI_Wtime();
  const Lattice lattice(job.scene, job.lattice);
  const bool done_already = !mpi::on_root(comm, [&] {
                               return prepare_output(job, options.overwrite) ? "done" : "";
                             }).empty();
  if (done_already) return std::nullopt;

  Index3 edge = options.tile_edge;
  for (std::size_t d = 0; d < 3; ++d) edge[d] = std::min(edge[d], lattice.extent()[d]);
  const Tiling tiling(lattice, edge);
  const auto rank = static_cast<std::uint64_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint64_t>(mpi::size(comm));
  Archive archive(job.output.file, lattice, tiling, map_infos(job.output), job.output.compression,
                  comm);
  describe(archive, job, options, static_cast<int>(ranks));

  Progress progress(lattice.designs(), rank == 0 ? options.progress : ProgressStyle::none);
  const std::size_t bytes_per_tile =
      edge[0] * edge[1] * edge[2] * job.output.fields.size() * sizeof(double);
  Tally tally;
  double integration_seconds = 0;
  std::uint64_t next = 0, done = 0, batch = 1;
  while (next < tiling.size()) {
    // A round: tiles [next, end), dealt to the ranks like cards; computed, then written together.
    const double round_start = MPI_Wtime();
    const std::uint64_t end = std::min(next + batch * ranks, tiling.size());
    std::vector<std::vector<Map>> computed;
    std::uint64_t designs = 0;
    for (std::uint64_t t = next + rank; t < end; t += ranks) {
      const Tile tile = tiling.tile(t);
      computed.push_back(
          with_stepper<double>(job.solver.stepper, [&]<class Stepper>(std::type_identity<Stepper>) {
            return integrate<Stepper>(job, lattice, tile, tally);
          }));
      designs += lattice.designs_in(tile);
    }
    const double round_seconds = MPI_Wtime() - round_start;
    integration_seconds += round_seconds;

    for (std::uint64_t first = next, b = 0; first < end; first += ranks, ++b) {
      if (first + rank < end)
        archive.write(tiling.tile(first + rank), computed[b]);
      else
        archive.write(std::nullopt, {});
    }
    archive.mark_done(next, end - next);
    next = end;
    mpi::sum({&designs, 1}, comm);
    done += designs;
    progress.update(done);
    batch = next_batch(batch, mpi::max(round_seconds, comm), bytes_per_tile);
  }

  Summary summary = combine(tally, lattice, comm);
  summary.integration_seconds = mpi::max(integration_seconds, comm);
  summary.sweep_seconds = mpi::max(MPI_Wtime() - start, comm);
  describe(archive, summary);
  archive.finish();
  return summary;
}

std::string to_text(const Summary& summary, const Job& job, int ranks) {
  std::string text = fmt::format("designs   {}\n", summary.designs());
  for (std::size_t s = 0; s < status_names.size(); ++s)
    if (summary.statuses[s] > 0)
      text += fmt::format("          {} {}\n", summary.statuses[s], status_names[s]);
  if (const auto& best = summary.optimum)
    text += fmt::format(
        "optimum   {:.8f} m/s at r1 = {}, r2 = {}, r3 = {} m, released at {:.8g} s\n", best->speed,
        best->design.r1, best->design.r2, best->design.r3, best->release_time);
  else
    text += "optimum   none: nothing was released\n";
  text += fmt::format("steps     {}\n", summary.steps);
  text += fmt::format("seconds   {:.2f} ({:.2f} integrating) on {} {}\n", summary.sweep_seconds,
                      summary.integration_seconds, ranks, ranks == 1 ? "rank" : "ranks");
  return text + fmt::format("archive   {}\n", job.output.file);
}

}  // namespace trebsweep
