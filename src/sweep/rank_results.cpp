#include "trebsweep/sweep/rank_results.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <span>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"

namespace trebsweep {
namespace {

/// For each tile or scene, the lowest rank that has its results, or `nobody`.
using Owners = std::vector<std::uint32_t>;
constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

void combine(Owners& owners, MPI_Comm comm) {
  const auto lower = [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); };
  mpi::combine(std::span(owners), lower, comm);
}

std::vector<std::uint64_t> unowned(const Owners& owners) {
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t n = 0; n < owners.size(); ++n)
    if (owners[n] == nobody) numbers.push_back(n);
  return numbers;
}

}  // namespace

RankResults::RankResults(const std::filesystem::path& folder, std::size_t run, double start,
                         const Study& study, const Tiling& tiling, MPI_Comm comm)
    : tiling_(tiling),
      journal_(journal_path(folder, run, mpi::rank(comm))),
      written_(start),
      best_(study.scenes()),
      optima_(is_study(study.job()) ? study.scenes() : 0) {
  const auto rank = static_cast<std::uint32_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  const auto maps = map_infos(study.job().output);
  Owners tiles(tiling.size(), nobody), scenes(optima_.size(), nobody);
  const auto claim = [&](const Record& record) {
    const bool is_tile = record.kind == RecordKind::tile;
    Owners& owners = is_tile ? tiles : scenes;
    const std::uint64_t n = record.number;
    if (n >= owners.size() || owners[n] == rank) return;
    if (is_tile ? !fits(record, tiling.tile(n), maps)
                : record.results.size() != sizeof(SceneOptimum))
      return;
    owners[n] = rank;
    earlier_.push_back(record);
  };
  if (run > 0) {
    mpi::on_all(comm, [&] {
      const auto paths = journals_in(folder);
      for (std::size_t n = rank; n < paths.size(); n += ranks)
        for (const Record& record : intact_records(journals_.emplace_back(paths[n]).bytes()))
          claim(record);
    });
    combine(tiles, comm);
    combine(scenes, comm);
  }
  std::erase_if(earlier_, [&](const Record& record) {
    return (record.kind == RecordKind::tile ? tiles : scenes)[record.number] != rank;
  });
  for (const Record& record : earlier_) count(record);
  tiles_to_do_ = unowned(tiles);
  scenes_to_do_ = unowned(scenes);
}

void RankResults::count(const Record& record) {
  if (record.kind == RecordKind::tile) {
    const Tally tally = to_tile_results(record).tally;
    BestCell& best = best_[tiling_.tile(record.number).scene];
    tally_.add(tally);
    if (tally.best > best) best = tally.best;
  } else {
    std::memcpy(&optima_[record.number], record.results.data(), sizeof(SceneOptimum));
  }
}

void RankResults::add(const Record& record) {
  constexpr double seconds = 2;
  constexpr std::size_t bytes = std::size_t{64} << 20;
  journal_.append(record);
  count(record);
  if (MPI_Wtime() - written_ < seconds && journal_.unwritten_bytes() < bytes) return;
  journal_.write();
  written_ = MPI_Wtime();
}

void RankResults::combine_tallies(MPI_Comm comm) {
  const auto sum = [](Tally a, const Tally& b) { return a.add(b), a; };
  mpi::combine(std::span(&tally_, 1), sum, comm);
}

void RankResults::combine_best(MPI_Comm comm) {
  const auto better = [](const BestCell& a, const BestCell& b) { return a > b ? a : b; };
  mpi::combine(std::span(best_), better, comm);
}

void RankResults::combine_optima(MPI_Comm comm) {
  const auto known = [](const SceneOptimum& a, const SceneOptimum& b) {
    return a.exists() ? a : b;
  };
  mpi::combine(std::span(optima_), known, comm);
}

std::vector<TileResults> RankResults::tiles() {
  auto records = journal_.records();
  records.insert(records.begin(), earlier_.begin(), earlier_.end());
  std::vector<TileResults> results;
  for (const Record& record : records)
    if (record.kind == RecordKind::tile) results.push_back(to_tile_results(record));
  return results;
}

}  // namespace trebsweep
