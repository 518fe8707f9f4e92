#include "trebsweep/sweep/rank_results.hpp"

#include <algorithm>
#include <span>

#include "trebsweep/archive/partial.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
RankResults::RankResults(const std::filesystem::path& folder, std::size_t run, double start,
                         const Study& study, const Tiling& tiling, MPI_Comm comm)
    : tiling_(tiling),
      journal_(journal_path(folder, run, mpi::rank(comm)), sweep_id(study.job(), tiling)),
      written_(start),
      totals_(study.scenes()) {
  const auto rank = static_cast<std::uint32_t>(mpi::rank(comm));
  const auto ranks = static_cast<std::uint32_t>(mpi::size(comm));
  // For each record of the sweep, the lowest rank that has it, or none.
  std::vector<std::uint32_t> owners(tiling.size() + study.scenes(), ranks);
  if (run > 0) {
    std::vector<std::filesystem::path> share;  // of the journals of earlier runs
    mpi::on_all(comm, [&] {
      for (std::size_t n = 0; const auto& journal : journals_in(folder))
        if (n++ % ranks == rank) share.push_back(journal);
      earlier_ = read_records(share, study, tiling);
    });
    for (const Record& record : earlier_.records) owners[record.number] = rank;
    constexpr auto lower = [](std::uint32_t a, std::uint32_t b) { return std::min(a, b); };
    mpi::combine<lower>(std::span(owners), comm);
    std::erase_if(earlier_.records, [&](const Record& r) { return owners[r.number] != rank; });
    for (const Record& record : earlier_.records) totals_.add(record, tiling);
  }
  for (std::uint64_t n = 0; n < owners.size(); ++n) {
    if (owners[n] < ranks) continue;
    n < tiling.size() ? tiles_to_do_.push_back(n) : scenes_to_do_.push_back(n - tiling.size());
  }
}

void RankResults::add(std::uint64_t number, std::vector<std::byte> results) {
  constexpr double seconds = 1;
  constexpr std::size_t bytes = std::size_t{64} << 20;
  totals_.add({number, results}, tiling_);
  journal_.append(number, std::move(results));
  if (MPI_Wtime() - written_ < seconds && journal_.unwritten_bytes() < bytes) return;
  journal_.write();
  written_ = MPI_Wtime();
}

void RankResults::combine_tiles(MPI_Comm comm) {
  constexpr auto sum = [](Tally a, const Tally& b) { return a.add(b), a; };
  mpi::combine<sum>(std::span(&totals_.tally, 1), comm);
  mpi::combine<better>(std::span(totals_.best), comm);
}

void RankResults::combine_optima(MPI_Comm comm) {
  mpi::combine<better>(std::span(totals_.optima), comm);
}

std::vector<Record> RankResults::tiles() {
  auto records = journal_.records();
  records.insert(records.begin(), earlier_.records.begin(), earlier_.records.end());
  std::erase_if(records, [&](const Record& record) { return record.number >= tiling_.size(); });
  return records;
}

}  // namespace trebsweep
