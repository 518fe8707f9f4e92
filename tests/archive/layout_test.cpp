#include "trebsweep/archive/layout.hpp"

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
  CHECK(dataset_name(Field::release_time) == "release_time");
  CHECK(H5Tequal(file_type(Field::speed, Storage::float64), H5T_IEEE_F64LE) > 0);
  CHECK(H5Tequal(file_type(Field::speed, Storage::float32), H5T_IEEE_F32LE) > 0);
  CHECK(std::isnan(fill_value(Field::speed)));
  CHECK(H5Tequal(file_type(Field::status, Storage::float32), H5T_STD_U8LE) > 0);
  CHECK(fill_value(Field::slack) == 0);
  Output output;
  output.fields = {Field::release_time, Field::status};
  output.storage = Storage::float32;
  CHECK(bytes_in({{}, {2, 3, 5}}, output) == 2 * 3 * 5 * (4 + 1));
  output.maps = Maps::none;
  CHECK(bytes_in({{}, {2, 3, 5}}, output) == 0);
}
