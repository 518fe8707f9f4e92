#include "trebsweep/archive/layout.hpp"

#include <algorithm>
#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

using Extents = std::vector<hsize_t>;

TEST_CASE("The outer axes of a study precede r1, r3 and r2, the last of them the fastest") {
  const Block block{{1, 2, 3}, {4, 5, 6}};
  const Extents single = map_extents(Study(Job{}));
  CHECK(single == Extents{99, 120, 119});
  CHECK(map_block({0, block}, single).first == Extents{1, 2, 3});
  CHECK(map_block({0, block}, single).count == Extents{4, 5, 6});

  const Study study(
      parse_job("[scene]\nprojectile-mass = 1, 2\nsling-mass = 0:2:1\n", "a.cfg", {}));
  const Extents extents = map_extents(study);
  CHECK(extents == Extents{2, 3, 99, 120, 119});
  for (std::uint64_t scene = 0; scene < 6; ++scene)
    CHECK(map_block({scene, block}, extents).first == Extents{scene / 3, scene % 3, 1, 2, 3});
  CHECK(map_block({5, block}, extents).count == Extents{1, 1, 4, 5, 6});
}

TEST_CASE("Maps of numbers have the job's storage and NaN outside the lattice, flags are bytes") {
  Output output;
  output.fields = {Field::release_time, Field::status};
  output.storage = Storage::float32;
  const auto maps = map_infos(output);
  REQUIRE(maps.size() == 2);
  CHECK(maps[0].dataset == "release_time");
  CHECK(maps[0].units == "s");
  CHECK(maps[0].ancillary == "status");
  CHECK(maps[0].type == MapType::float32);
  CHECK(std::isnan(maps[0].fill));
  CHECK(maps[0].flag_meanings.empty());
  CHECK(maps[1].ancillary.empty());
  CHECK(maps[1].type == MapType::uint8);
  CHECK(maps[1].fill == 0);
  CHECK(maps[1].flag_meanings.size() == status_names.size());
  CHECK(bytes_in({{}, {2, 3, 5}}, maps) == 2 * 3 * 5 * (4 + 1));
}

TEST_CASE("The checksums of a tile are those of the maps, of a study's optima and of the counts") {
  Output output;
  output.fields = {Field::release_time, Field::status};
  const auto maps = map_infos(output);
  using Columns = std::vector<std::string>;
  CHECK(checksum_columns(maps, false) == Columns{"release_time", "status", "tile_designs"});
  CHECK(checksum_columns(maps, true) == Columns{"release_time", "status", "best", "tile_designs"});
  CHECK(checksum_columns({}, false) == Columns{"tile_designs"});
}

TEST_CASE("The attributes name the objective, and hold its best value in its unit") {
  Job job;
  job.optimum.objective = Field::impact_speed;
  Summary summary;
  summary.optima = {to_best_design({20, 15, 0.5, 0.6, 0.7, 1, 1e-9})};
  Attributes attributes = root_attributes(job, "a run", summary);
  const auto value = [&](const std::string& key) {
    return std::ranges::find(attributes, key, &Attributes::value_type::first)->second;
  };
  CHECK(std::get<std::string>(value("objective")) == "impact-speed");
  CHECK(std::get<std::string>(value("objective_units")) == "m s-1");
  CHECK(std::get<std::string>(value("history")) == "a run");
  CHECK(std::get<double>(value("best_value")) == 20);
  CHECK(std::get<double>(value("best_speed")) == 15);
  CHECK(std::get<double>(value("best_r3")) == 0.6);
  CHECK(std::get<double>(value("best_error")) == 1e-9);

  // Of a study those of the best scene, and NaN if no scene has an optimum.
  summary.optima = {summary.optima[0], to_best_design({21, 14, 0.8, 0.6, 0.7, 1, 1e-9}), {}};
  attributes = root_attributes(job, "a run", summary);
  CHECK(std::get<double>(value("best_speed")) == 14);
  summary.optima = {BestDesign{}};
  attributes = root_attributes(job, "a run", summary);
  for (const std::string_view name : best_names)
    CHECK(std::isnan(std::get<double>(value(std::string(name)))));
}
