#include "trebsweep/base/text_table.hpp"

#include "support/catch.hpp"

using namespace trebsweep;

TEST_CASE("Columns of a table are as wide as their widest cell, two spaces apart") {
  using Lines = std::vector<std::string>;
  CHECK(
      aligned({{{"name", "ox", "gnat"}, true}, {{"mass", "800", "-"}}, {{"u", "kg", ""}, true}}) ==
      Lines{"name  mass  u", "ox     800  kg", "gnat     -"});
  CHECK(aligned({{{"", "1"}}}) == Lines{"", "1"});
}
