#include "trebsweep/job/outer_axis.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/job.hpp"
#include "trebsweep/job/unit.hpp"

using namespace trebsweep;

namespace {

OuterAxis axis(const std::string& text) {
  return to_outer_axis("scene.x", text, "", [](const std::string& word) {
    return to_number("scene.x", word, positive, "");
  });
}

/// The outer axes of a job with one line in [scene].
std::vector<OuterAxis> axes_of(const std::string& line) {
  return parse_job("[scene]\n" + line + "\n", "study.cfg", {}).outer_axes;
}

}  // namespace

TEST_CASE("The values of a range are the doubles nearest to their decimals, with both ends") {
  const OuterAxis tenths = axis("0.1:0.9:0.1");
  CHECK(tenths.values == std::vector{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9});
  CHECK(tenths.text == "0.1:0.9:0.1");
  CHECK(axis(" 50 : 200 : 50 ").values == std::vector<double>{50, 100, 150, 200});
  CHECK(axis(" 50 : 200 : 50 ").text == "50:200:50");
  CHECK(axis("5:5:1").values == std::vector<double>{5});
  CHECK(axis("1:1e6:1").values.size() == 1000000);
}

TEST_CASE("The values of a list are sorted") {
  CHECK(axis("5000, 1000, 2000").values == std::vector<double>{1000, 2000, 5000});
  CHECK(axis(" 3,1 ").values == std::vector<double>{1, 3});
  CHECK(axis(" 3,1 ").text == "1, 3");
}

TEST_CASE("The text of an axis gives the same axis again") {
  for (const char* text : {"0.1:0.9:0.1", "50:200:50", "7, 0.3, 1e-05", "5:5:1"}) {
    const OuterAxis once = axis(text), twice = axis(once.text);
    CHECK(twice.values == once.values);
    CHECK(twice.text == once.text);
  }
}

TEST_CASE("A text with a comma or a colon means several values") {
  for (const char* text : {"1:2:1", "1, 2", "1,2", "1,", ","}) CHECK(has_several_values(text));
  for (const char* text : {"1", " 1 ", "1 2", "1e5", ""}) CHECK_FALSE(has_several_values(text));
}

TEST_CASE("A bad range or list is refused with the key, the text and what is allowed") {
  const auto refused = [](const std::string& text, const std::string& why) {
    CHECK_THROWS_AS(axis(text), InputError);
    CHECK_THROWS_WITH(axis(text), contains("scene.x = ") && contains(why));
  };
  refused("2:1:0.5", "must be first:last:step with a step above 0 and first <= last");
  refused("1:2", "must be first:last:step with a step above 0");
  refused("1:2:3:4", "must be first:last:step");
  refused("1:2:0", "step above 0");
  refused("1:2:-1", "step above 0");
  refused("1:2:nan", "step above 0");
  refused("1:2:inf", "step above 0");
  refused("1:2:0.3", "1:2:0.3");
  refused("1::1", "1::1: must be first:last:step with a step above 0");
  refused("1, 2:3:1", "1, 2:3:1: must be first:last:step with a step above 0");
  for (const std::string text : {":", "::", ":2:1", "1:2:", "1:2:1, 3"})
    refused(text, text +
                      ": must be first:last:step with a step above 0 and first <= last, or "
                      "numbers separated by commas");
  refused("1:inf:1", "inf: must be a finite number above 0");
  refused("50:200:70",
          "a range whose last value is an integer number of steps from the first; "
          "the nearest are 190 and 260");
  for (const char* text : {"1:1e9:1", "1:1e12:1", "50:200:1e-300"})
    refused(text, "a range of at most 1000000 values");
  for (const char* text : {"1, 2, 1", "1,1e0", "1, 1.00000000000000000001"})
    refused(text, "numbers that differ; 1 is repeated");
  refused("1:1.00000000000001:1e-15", "numbers that differ; 1 is repeated");
  refused("1, -2, 3", "-2: must be a finite number above 0");
  refused("-1:2:1", "-1: must be a finite number above 0");
  refused("1, two", "two: must be a finite number above 0");
  for (const char* text : {",", " , ", "1,", ",1", "1,,2"})
    refused(text, "must be numbers separated by commas, or first:last:step");
  refused("1 2, 3", "scene.x = 1 2: must be a finite number above 0");
  refused("1;2", "scene.x = 1;2: must be a finite number above 0");
  refused("[1, 2]", "scene.x = [1: must be a finite number above 0");
}

TEST_CASE("Keys of [scene] with several values are axes in the order of the keys") {
  const auto axes =
      axes_of("wind = -3, 3\nprojectile-diameter = 0.1:0.2:0.05\ngravity = 9.8, 1.62");
  REQUIRE(axes.size() == 3);
  CHECK(axes[0].key == "scene.gravity");
  CHECK(axes[0].name() == "gravity");
  CHECK(axes[0].values == std::vector{1.62, 9.8});
  CHECK(axes[1].name() == "projectile-diameter");
  CHECK(axes[1].values == std::vector{0.1, 0.15, 0.2});
  CHECK(axes[2].values == std::vector<double>{-3, 3});
}

TEST_CASE("Each of several values is in the range of the key") {
  CHECK_THROWS_WITH(
      axes_of("projectile-mass = 50:1e13:50"),
      contains("scene.projectile-mass = 1e13: must be a number above 0, from 1e-12 to 1e+12"));
  CHECK_THROWS_WITH(
      axes_of("sling-angle = 0, 1, 4"),
      contains("scene.sling-angle = 4: must be a number from -3.14159265 to 3.14159265"));
}

TEST_CASE("A key has several values only if it is a number of [scene]") {
  CHECK(axes_of("projectile-mass = 50").empty());
  CHECK_THROWS_WITH(axes_of("trough = yes, no"), contains("scene.trough = yes, no: must be"));
  CHECK_THROWS_WITH(axes_of("[solver]\nmax-time = 1, 2"), contains("solver.max-time = 1, 2"));
}
