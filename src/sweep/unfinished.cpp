#include "trebsweep/sweep/unfinished.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "trebsweep/base/version.hpp"

namespace trebsweep {

Unfinished read_unfinished(const std::filesystem::path& folder) {
  const PartialSweep description = read_partial_sweep(folder);
  const Study study(parse_job(description.job, folder, {}));
  const Tiling tiling(study, description.tile_edge);
  if (description.numerics != numerics_version)
    throw std::runtime_error(fmt::format("of another version: {}", description.source));
  auto [journals, records] = read_records(journals_in(folder), study, tiling);
  Totals totals(study.scenes());
  for (const Record& record : records) totals.add(record, tiling);
  std::erase_if(records, [&](const Record& record) { return record.number >= tiling.size(); });
  Summary summary = totals.summary();
  summary.complete = false;
  return {description, study, tiling, std::move(journals), std::move(records), summary};
}

void write_snapshot(const std::filesystem::path& path, const Unfinished& sweep) {
  const Summary& summary = sweep.summary;
  write_archive(path, {sweep.study, sweep.tiling, summary.optima}, sweep.tiles);
  write_attributes(path, sweep.study.job(), sweep.description.history, summary);
}

}  // namespace trebsweep
