#include "trebsweep/base/number.hpp"

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

TEST_CASE(
    "parse_number accepts a number with surrounding spaces and a leading +, and nothing else") {
  double x = 0;
  for (const std::string good : {"1.5", " 1.5 ", "+1.5", "15e-1"}) {
    CHECK(parse_number(good, x));
    CHECK(x == 1.5);
  }
  for (const std::string bad : {"", " ", "1.5 m", "1,5", "0x1", "--1", "+-1", "1.5.", "1e999"})
    CHECK_FALSE(parse_number(bad, x));
  std::uint64_t n = 0;
  CHECK(parse_number("18446744073709551615", n));
  CHECK_FALSE(parse_number("18446744073709551616", n));
  CHECK_FALSE(parse_number("-1", n));
}

TEST_CASE("Durations are in seconds, or in the colon notation of batch systems") {
  const auto seconds = [](const std::string& text) { return to_seconds("time-limit", text); };
  CHECK(seconds("90") == 90);
  CHECK(seconds("0.5") == 0.5);
  CHECK(seconds("1:30") == 90);
  CHECK(seconds("02:00:05") == 7205);
  CHECK(seconds("1-12:00:00") == 129600);
  for (const char* text :
       {"", "0", "-5", "nan", "1:", ":30", "1-12", "1-12:00", "1:2:3:4", "1-2-3:4:5", "x", "1:-2"})
    CHECK_THROWS_WITH(seconds(text), contains(std::string("time-limit = ") + text + ": must be"));
}

TEST_CASE("Only the largest unit of a duration may exceed the next larger one") {
  const auto seconds = [](const std::string& text) { return to_seconds("time-limit", text); };
  CHECK(seconds("600") == 600);
  CHECK(seconds("90:00") == 5400);
  CHECK(seconds("48:59:59.5") == 176399.5);
  CHECK(seconds("40-23:00:00") == 3538800);
  for (const char* text : {"1:60", "1:90.5", "1:60:00", "0:0:60", "1-24:00:00", "1-00:99:00"})
    CHECK_THROWS_WITH(seconds(text),
                      contains("with seconds and minutes below 60 and hours below 24"));
}

TEST_CASE("Units are printed in common notation") {
  CHECK(unit_text("m s-1") == "m/s");
  CHECK(unit_text("rad s-1") == "rad/s");
  CHECK(unit_text("Pa") == "Pa");
  CHECK(unit_text("1") == "");
}

TEST_CASE("Sizes are printed in the largest unit that they fill") {
  CHECK(size_text(0) == "0 bytes");
  CHECK(size_text(999'999) == "999999 bytes");
  CHECK(size_text(34'560'000) == "34.56 MB");
  CHECK(size_text(999'999'999) == "1000 MB");
  CHECK(size_text(1'234'567'890) == "1.235 GB");
}
