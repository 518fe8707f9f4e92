#include "trebsweep/sweep/results.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "support/temporary_directory.hpp"

using namespace trebsweep;

namespace {

/// The results of a tile with one design, without maps.
std::vector<std::byte> tile_with(const SwingResult& result, const Design<double>& design,
                                 double value) {
  Tally tally;
  tally.add(result, 7, design, value);
  tally.lane_steps = 2 * result.steps;
  return to_bytes(tally, {}, {});
}

SwingResult released(double speed) { return {speed, speed / 10, 10, Status::released}; }

Record tile_record(std::uint64_t number, const std::vector<std::byte>& bytes) {
  return {number, bytes};
}

}  // namespace

TEST_CASE("The optimum of a scene is the best design of its tiles until it is found") {
  const SmallStudy small(without_maps(job_of_six_scenes()));
  const Design<double> first{0.5, 0.6, 0.7}, last{0.6, 0.6, 0.7};
  const TileRange tiles = small.tiling.of_scene(1);
  Totals totals(small.study.scenes());
  totals.add(tile_record(tiles.first, tile_with(released(8), first, -9)), small.tiling);
  totals.add(tile_record(tiles.first + 1, tile_with(released(7), last, -3)), small.tiling);
  totals.add(tile_record(tiles.end - 1, tile_with(released(6), first, -3)), small.tiling);
  totals.add(tile_record(tiles.end, tile_with(released(5), first, -4)), small.tiling);
  totals.add(tile_record(0, tile_with({99, 0, 5, Status::not_released}, first, 99)), small.tiling);
  Summary summary = totals.summary();
  CHECK(summary.tally.designs() == 5);
  CHECK(summary.tally.statuses[static_cast<std::size_t>(Status::released)] == 4);
  CHECK(summary.tally.statuses[static_cast<std::size_t>(Status::not_released)] == 1);
  CHECK(summary.tally.steps == 45);
  CHECK(summary.tally.utilisation() == 0.5);
  CHECK(summary.best() == 1u);
  CHECK(summary.optima[1].value == -3);
  CHECK(summary.optima[1].speed == 6);
  CHECK(summary.optima[1].release_time == 0.6);
  CHECK(summary.optima[1].design == first);
  CHECK(std::isnan(summary.optima[1].error));
  CHECK(summary.optima[2].value == -4);
  CHECK_FALSE(summary.optima[0].exists());

  const auto found = to_bytes(optimum_of(5));
  totals.add({small.tiling.size() + 2, found}, small.tiling);
  summary = totals.summary();
  CHECK(to_numbers(summary.optima[2]) == to_numbers(optimum_of(5)));
  CHECK(summary.best() == 2u);
  CHECK(summary.optima[1].value == -3);
  CHECK(totals.best[2].value == -4);
}

TEST_CASE("Without a release there is no optimum") {
  const SmallStudy small(without_maps(job_of_six_scenes()));
  Totals totals(small.study.scenes());
  totals.add(
      tile_record(0, tile_with({no_value, no_value, 1, Status::non_finite}, {1, 1, 1}, no_value)),
      small.tiling);
  CHECK(totals.summary().tally.designs() == 1);
  CHECK_FALSE(totals.summary().best());
}

TEST_CASE("Of each tile and scene the first fitting record of the journals is read") {
  const TemporaryDirectory directory;
  const SmallStudy small(without_maps(job_of_six_scenes()));
  const std::vector<std::filesystem::path> paths{directory / "1", directory / "2"};
  const auto bytes = tile_with(released(1), {1, 1, 1}, 1), later = tile_with(released(2), {}, 2);
  auto longer = bytes;
  longer.push_back({});
  const BestDesign optimum = optimum_of(0);
  const std::uint64_t tiles = small.tiling.size();
  {
    const std::uint64_t id = sweep_id(small.study.job(), small.tiling);
    Journal first(paths[0], id), second(paths[1], id), other(paths[1].string() + "x", id + 1);
    other.append(0, bytes);
    other.write();
    first.append(4, longer);
    first.append(3, bytes);
    first.append(tiles + 3, to_bytes(optimum));
    first.append(tiles + 4, bytes);
    first.write();
    second.append(3, later);
    second.append(4, later);
    second.append(tiles + 3, to_bytes(optimum_of(1)));
    second.append(tiles + small.study.scenes(), to_bytes(optimum));
    second.write();
  }
  const std::filesystem::path of_another = paths[1].string() + "x";
  CHECK(read_records(std::vector{of_another}, small.study, small.tiling).records.empty());
  const StoredRecords stored = read_records(paths, small.study, small.tiling);
  REQUIRE(stored.records.size() == 3);
  const auto has = [&](std::size_t n, std::uint64_t number, std::span<const std::byte> results) {
    const Record& record = stored.records[n];
    return record.number == number && std::ranges::equal(record.results, results);
  };
  CHECK(has(0, 3, bytes));
  CHECK(has(1, tiles + 3, to_bytes(optimum)));
  CHECK(has(2, 4, later));
  CHECK_THROWS_WITH(read_records(std::vector{directory / "3"}, small.study, small.tiling),
                    contains("cannot read"));
}
