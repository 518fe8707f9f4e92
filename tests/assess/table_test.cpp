#include "trebsweep/assess/table.hpp"

#include <hdf5_hl.h>

#include <array>
#include <filesystem>
#include <limits>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

Table fruit() {
  return {"fruit",
          "What there is",
          {{"name", "", "its name", std::vector<std::string>{"apple", "fig"}},
           {"mass", "kg", "its mass",
            std::vector<double>{0.15, std::numeric_limits<double>::quiet_NaN()}},
           {"count", "1", "how many", std::vector<double>{3, 12}, false}}};
}

}  // namespace

TEST_CASE("Printed tables are aligned, with units, a dash for NaN, and without hidden columns") {
  CHECK(to_text(fruit()) == "What there is\nname   mass\n         kg\napple  0.15\nfig       -\n");
}

TEST_CASE("A stored table has a dataset per column, along one dimension") {
  const std::filesystem::path path = TEST_DIR "/table_test.h5";
  {
    hdf5::File file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "create");
    write(file, fruit());
  }
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open");
  const hdf5::Dataset count(H5Dopen2(file, "fruit/count", H5P_DEFAULT), "open");
  std::array<double, 2> values{};
  H5Dread(count, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  CHECK(values == std::array<double, 2>{3, 12});
  const hdf5::Dataset rows(H5Dopen2(file, "fruit/row", H5P_DEFAULT), "open");
  CHECK(H5DSis_attached(count, rows, 0) == 1);
  CHECK(hdf5::read_text_attribute(count, "long_name") == "how many");
  std::filesystem::remove(path);
}
