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

TEST_CASE("The attributes name the objective, and hold its best value in its unit") {
  Job job;
  job.optimum.objective = Field::impact_speed;
  Summary summary;
  summary.optimum = {{0.5, 0.6, 0.7}, 20, 15, 1};
  const auto attributes = root_attributes(job, "a run", summary);
  const auto value = [&](const std::string& key) {
    return std::ranges::find(attributes, key, &Attributes::value_type::first)->second;
  };
  CHECK(std::get<std::string>(value("objective")) == "impact-speed");
  CHECK(std::get<std::string>(value("objective_units")) == "m s-1");
  CHECK(std::get<std::string>(value("history")) == "a run");
  CHECK(std::get<double>(value("best_value")) == 20);
  CHECK(std::get<double>(value("best_speed")) == 15);
  CHECK(std::isnan(std::get<double>(value("refined_error"))));
}
