#include "trebsweep/sweep/results.hpp"

#include <cstring>

#include "trebsweep/archive/checksum.hpp"

namespace trebsweep {

std::uint64_t sweep_id(const Job& job, const Tiling& tiling) {
  Job same = job;
  same.output.file.clear();
  same.assess = {};
  const std::string text = to_text(same);
  const Index3& edge = tiling.edge();
  return checksum(std::as_bytes(std::span(text)), checksum(std::as_bytes(std::span(edge))));
}

StoredRecords read_records(std::span<const std::filesystem::path> journals, const Study& study,
                           const Tiling& tiling) {
  std::vector<bool> has(tiling.size() + study.scenes());
  const auto size_of = [&](std::uint64_t number) {
    return number < tiling.size() ? result_bytes(tiling.tile(number).block, study.job().output)
                                  : sizeof(BestDesign);
  };
  const std::uint64_t id = sweep_id(study.job(), tiling);
  StoredRecords stored;
  for (const auto& path : journals)
    for (const Record& record :
         intact_records(bytes_of(stored.journals.emplace_back(map_file(path))), id)) {
      const auto& [number, results] = record;
      if (number >= has.size() || has[number] || results.size() != size_of(number)) continue;
      has[number] = true;
      stored.records.push_back(record);
    }
  return stored;
}

std::vector<std::byte> to_bytes(const BestDesign& optimum) {
  const auto bytes = std::as_bytes(std::span(&optimum, 1));
  return {bytes.begin(), bytes.end()};
}

void Totals::add(const Record& record, const Tiling& tiling) {
  if (record.number >= tiling.size()) {
    std::memcpy(&optima[record.number - tiling.size()], record.results.data(), sizeof(BestDesign));
    return;
  }
  const Tally of_tile = tally_of(record);
  tally.add(of_tile);
  BestDesign& of_scene = best[tiling.tile(record.number).scene];
  of_scene = better(of_tile.best, of_scene);
}

Summary Totals::summary() const {
  Summary summary{.tally = tally, .optima = best, .error = {}};
  for (std::uint64_t scene = 0; scene < optima.size(); ++scene)
    if (optima[scene].exists()) summary.optima[scene] = optima[scene];
  return summary;
}

}  // namespace trebsweep
