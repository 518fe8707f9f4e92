#include "trebsweep/sweep/unfinished.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstring>
#include <stdexcept>

#include "trebsweep/base/version.hpp"
#include "trebsweep/sweep/archive_metadata.hpp"

namespace trebsweep {

Unfinished::Unfinished(const std::filesystem::path& folder)
    : description_(read_partial_sweep(folder)),
      study_(parse_job(description_.job, folder, {})),
      tiling_(study_, description_.tile_edge),
      maps_(map_infos(study_.job().output)) {
  if (description_.numerics != numerics_version)
    throw std::runtime_error(fmt::format("of another version: {}", description_.source));
  if (is_study(study_.job())) optima_.resize(study_.scenes());
  std::vector<bool> done(tiling_.size());
  for (const auto& path : journals_in(folder))
    for (const Record& record : intact_records(journals_.emplace_back(path).bytes())) {
      if (record.kind == RecordKind::scene) {
        if (record.number < optima_.size() && record.results.size() == sizeof(SceneOptimum))
          std::memcpy(&optima_[record.number], record.results.data(), sizeof(SceneOptimum));
      } else if (record.number < done.size() && !done[record.number] &&
                 fits(record, tiling_.tile(record.number), maps_)) {
        done[record.number] = true;
        tiles_.push_back(to_tile_results(record));
      }
    }
}

Summary Unfinished::summary() const {
  Tally tally;
  for (const TileResults& tile : tiles_) tally.add(tile.tally);
  Summary summary = to_summary(tally, study_);
  summary.optima = optima_;
  summary.refined = best_refined(study_.job(), optima_);
  summary.complete = false;
  return summary;
}

void Unfinished::write_snapshot(const std::filesystem::path& path) const {
  const Job& job = study_.job();
  const Attributes attributes =
      root_attributes(job, fmt::format("{}", fmt::join(description_.history, "\n")), summary());
  write_archive(path, {study_, tiling_, maps_, job.output.compression, attributes, optima_},
                tiles_);
}

}  // namespace trebsweep
