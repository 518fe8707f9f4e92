#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "trebsweep/archive/archive_writer.hpp"
#include "trebsweep/archive/journal.hpp"
#include "trebsweep/archive/summary.hpp"

namespace trebsweep {

/// Identifies a sweep to its journals: the job, except for its output file, and the tiles.
std::uint64_t sweep_id(const Job& job, const Tiling& tiling);

/// Records of journals, and the files to whose bytes they refer.
struct StoredRecords {
  std::vector<MappedFile> journals;
  std::vector<Record> records;
};

/// The results of tiles and scenes in the journals of a sweep: of each, the first record that is
/// intact and has the size of its results. Throws std::runtime_error.
StoredRecords read_records(std::span<const std::filesystem::path> journals, const Study& study,
                           const Tiling& tiling);

/// The optimum of a scene as the results of a record.
std::vector<std::byte> to_bytes(const BestDesign& optimum);

/// What the results of tiles and scenes amount to.
struct Totals {
  explicit Totals(std::uint64_t scenes) : best(scenes), optima(scenes) {}

  Tally tally;
  std::vector<BestDesign> best;    ///< of the tiles of each scene
  std::vector<BestDesign> optima;  ///< of scenes: scene_optimum()

  void add(const Record& record, const Tiling& tiling);

  /// The optimum of a scene is the best design of its tiles until it is found.
  Summary summary() const;
};

}  // namespace trebsweep
