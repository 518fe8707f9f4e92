#include "trebsweep/sweep/rank_results.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"

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

/// The journals of earlier runs that a rank reads.
std::vector<std::filesystem::path> share_of_journals(const std::filesystem::path& folder,
                                                     MPI_Comm comm) {
  std::vector<std::filesystem::path> share;
  const auto all = journals_in(folder);
  const auto ranks = static_cast<std::size_t>(mpi::size(comm));
  for (auto n = static_cast<std::size_t>(mpi::rank(comm)); n < all.size(); n += ranks)
    share.push_back(all[n]);
  return share;
}

}  // namespace

RankResults::RankResults(const std::filesystem::path& folder, std::size_t run, double start,
                         const Study& study, const Tiling& tiling, MPI_Comm comm)
    : tiling_(tiling),
      journal_(journal_path(folder, run, mpi::rank(comm)), sweep_id(study.job(), tiling)),
      written_(start),
      totals_(study.scenes()) {
  const auto rank = static_cast<std::uint32_t>(mpi::rank(comm));
  Owners tiles(tiling.size(), nobody), scenes(study.scenes(), nobody);
  if (run > 0) {
    mpi::on_all(comm,
                [&] { earlier_ = read_records(share_of_journals(folder, comm), study, tiling); });
    const auto owner = [&](const Record& record) -> std::uint32_t& {
      return (record.kind == RecordKind::tile ? tiles : scenes)[record.number];
    };
    for (const Record& record : earlier_.records) owner(record) = rank;
    combine(tiles, comm);
    combine(scenes, comm);
    std::erase_if(earlier_.records, [&](const Record& record) { return owner(record) != rank; });
    for (const Record& record : earlier_.records) totals_.add(record, tiling);
  }
  tiles_to_do_ = unowned(tiles);
  scenes_to_do_ = unowned(scenes);
}

void RankResults::add(RecordKind kind, std::uint64_t number, std::vector<std::byte> results) {
  constexpr double seconds = 1;
  constexpr std::size_t bytes = std::size_t{64} << 20;
  totals_.add({kind, number, results}, tiling_);
  journal_.append(kind, number, std::move(results));
  if (MPI_Wtime() - written_ < seconds && journal_.unwritten_bytes() < bytes) return;
  journal_.write();
  written_ = MPI_Wtime();
}

void RankResults::combine_tiles(MPI_Comm comm) {
  const auto sum = [](Tally a, const Tally& b) { return a.add(b), a; };
  mpi::combine(std::span(&totals_.tally, 1), sum, comm);
  const auto better = [](const BestDesign& a, const BestDesign& b) {
    return is_better(a, b) ? a : b;
  };
  mpi::combine(std::span(totals_.best), better, comm);
}

void RankResults::combine_optima(MPI_Comm comm) {
  const auto known = [](const BestDesign& a, const BestDesign& b) { return a.exists() ? a : b; };
  mpi::combine(std::span(totals_.optima), known, comm);
}

std::vector<Record> RankResults::tiles() {
  auto records = journal_.records();
  records.insert(records.begin(), earlier_.records.begin(), earlier_.records.end());
  std::erase_if(records, [](const Record& record) { return record.kind != RecordKind::tile; });
  return records;
}

}  // namespace trebsweep
