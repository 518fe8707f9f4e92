#include "trebsweep/sweep/archive_metadata.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

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
}

TEST_CASE("The attributes of a new archive include every attribute of its results") {
  const auto all = root_attributes(Job{}, "history", "");
  for (const auto& [name, value] : result_attributes(Summary{}))
    CHECK(std::any_of(all.begin(), all.end(),
                      [&, &key = name](const auto& each) { return each.first == key; }));
}

TEST_CASE("The attributes name the objective, and hold its best value in its unit") {
  Job job;
  job.optimum.objective = Field::impact_speed;
  const auto text = [&](const char* key) {
    for (const auto& [name, value] : root_attributes(job, "history", ""))
      if (name == key) return std::get<std::string>(value);
    return std::string("missing");
  };
  CHECK(text("objective") == "impact-speed");
  CHECK(text("objective_units") == "m s-1");
  Summary summary;
  summary.optimum = {{0.5, 0.6, 0.7}, 20, 15, 1};
  for (const auto& [name, value] : result_attributes(summary)) {
    if (name == "best_value") CHECK(std::get<double>(value) == 20);
    if (name == "best_speed") CHECK(std::get<double>(value) == 15);
  }
}
