#include "trebsweep/sweep/unfinished.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "trebsweep/base/version.hpp"

namespace trebsweep {

Unfinished::Unfinished(const std::filesystem::path& folder)
    : description_(read_partial_sweep(folder)),
      study_(parse_job(description_.job, folder, {})),
      tiling_(study_, description_.tile_edge) {
  if (description_.numerics != numerics_version)
    throw std::runtime_error(fmt::format("of another version: {}", description_.source));
  stored_ = read_records(journals_in(folder), study_, tiling_);
  for (const Record& record : stored_.records)
    if (record.kind == RecordKind::tile) tiles_.push_back(to_tile_results(record));
}

std::string Unfinished::history() const {
  return fmt::format("{}", fmt::join(description_.history, "\n"));
}

Summary Unfinished::summary() const {
  Totals totals(study_.scenes());
  for (const Record& record : stored_.records) totals.add(record, tiling_);
  Summary summary = totals.summary();
  summary.complete = false;
  return summary;
}

void Unfinished::write_snapshot(const std::filesystem::path& path) const {
  const Job& job = study_.job();
  const Summary so_far = summary();
  const auto maps = map_infos(job.output);
  const Attributes attributes = root_attributes(job, history(), so_far);
  write_archive(path, {study_, tiling_, maps, job.output.compression, attributes, so_far.optima},
                tiles_);
}

}  // namespace trebsweep
