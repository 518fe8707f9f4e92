#include "trebsweep/job/constraint.hpp"

#include <cmath>
#include <limits>

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

const std::string key = "optimum.subject-to";

}  // namespace

TEST_CASE("A constraint is read with and without spaces, and printed with them") {
  for (const std::string text : {"peak-axle-load <= 150000", "peak-axle-load<=1.5e5",
                                 "  peak-axle-load  <=+1.5e5 ", "peak-axle-load\t<=\t150e3"}) {
    INFO(text);
    const Constraint constraint = to_constraint(key, text);
    CHECK(constraint.expression.fields == std::vector{Field::peak_axle_load});
    CHECK(constraint.is_upper);
    CHECK(constraint.limit == 150000);
    CHECK(to_text(constraint) == "peak-axle-load <= 150000");
  }
  const Constraint lower = to_constraint(key, "least-sling-tension >= -0.5");
  CHECK(lower.expression.text == "least-sling-tension");
  CHECK_FALSE(lower.is_upper);
  CHECK(lower.limit == -0.5);
}

TEST_CASE("The text of a constraint is read back to the same field, side and limit") {
  for (const FieldInfo& field : field_info) {
    if (!is_quantity(field.field)) continue;
    for (const bool is_upper : {true, false})
      for (const double limit : {0.1 + 0.2, -1e-300, 1.2e8, std::numeric_limits<double>::max()}) {
        const Constraint read =
            to_constraint(key, to_text({to_expression(field.field), is_upper, limit}));
        CHECK(read.expression.fields == std::vector{field.field});
        CHECK(read.is_upper == is_upper);
        CHECK(read.limit == limit);
      }
  }
}

TEST_CASE("The message about a malformed constraint quotes it and says what is wrong") {
  const auto refused = [](const std::string& text, const std::string& why) {
    INFO(text);
    CHECK_THROWS_WITH(
        to_constraint(key, text),
        contains(key + " = " + text + ": must be FIELD <= NUMBER or FIELD >= NUMBER, " + why));
  };
  for (const std::string text :
       {"", "nonsense", "speed", "3", "speed 3", "speed < 3", "speed > 3", "speed == 3",
        "speed = 3", "speed => 3", "speed =< 3", "speed < = 3", "Speed < 3"})
    refused(text, "with the sign <= or >=, which includes the limit");
  for (const std::string text : {"<= 3", "3 <= speed", "0 <= speed <= 3", "Speed <= 3", "mass <= 3",
                                 "peak axle load <= 3", "peak_axle_load <= 3", "mass <= x"})
    refused(text, "where FIELD is one of speed, release-time, sling-angle, ");
  for (const std::string text :
       {"speed <=", "speed <= = 3", "speed <= x", "speed <= 0x10", "speed <= nan", "speed <= inf",
        "speed >= -inf", "speed <= 1e999", "speed <= 3 4", "speed <= 3 <= 4",
        "speed >= 1 speed <= 3", "speed <= range"})
    refused(text, "where NUMBER is finite");
}

TEST_CASE("A constraint may be on a formula, whose limit may have its unit") {
  const Constraint beam = to_constraint(key, "r1 + r2 <= 6.5 ft");
  CHECK(beam.expression.text == "r1 + r2");
  CHECK(beam.limit == Approx(1.9812));
  CHECK(to_text(to_constraint(key, "peak-axle-load/counterweight-mass  <=30")) ==
        "peak-axle-load/counterweight-mass <= 30");
  CHECK_THROWS_WITH(to_constraint(key, "r1 / r2 <= 3 m"), contains("finite, without a unit"));
  CHECK_THROWS_WITH(parse("[optimum]\nsubject-to = beam-mass <= 3\n"),
                    contains("beam-mass <= 3: must be left out unless scene.beam-mass is given"));
  CHECK_THROWS_WITH(
      parse("[scene]\nstart-angle = 1\n[optimum]\nsubject-to = release-height >= 1\n"),
      contains("release-height >= 1: must be without scene.release-height, which must be left out "
               "with scene.start-angle"));
}

TEST_CASE("Flags and properties of the integration are not quantities") {
  for (const std::string name :
       {"status", "slack", "steps", "energy-drift", "speed-error", "stiffness", "decay-rate"}) {
    INFO(name);
    CHECK_FALSE(to_quantity(name));
    CHECK_THAT(", " + quantity_names() + ",", !contains(", " + name + ","));
    CHECK_THROWS_AS(to_constraint(key, name + " <= 1"), InputError);
  }
  for (const std::string name : {"speed", "range", "efficiency", "peak-hanger-tension"}) {
    INFO(name);
    CHECK(to_quantity(name));
    CHECK_THAT(", " + quantity_names() + ",", contains(", " + name + ","));
  }
}

TEST_CASE("The violation of a constraint is positive beyond the limit and NaN for NaN") {
  const Constraint upper{to_expression(Field::peak_axle_load), true, 10};
  CHECK(violation(upper, 12) == 2);
  CHECK(violation(upper, 10) == 0);
  CHECK(violation(upper, 7) == -3);
  const Constraint lower{to_expression(Field::least_sling_tension), false, 10};
  CHECK(violation(lower, 12) == -2);
  CHECK(violation(lower, 7) == 3);
  CHECK(std::isnan(violation(upper, std::numeric_limits<double>::quiet_NaN())));
  CHECK(std::isnan(violation(lower, std::numeric_limits<double>::quiet_NaN())));
}
