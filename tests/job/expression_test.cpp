#include "trebsweep/job/expression.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace trebsweep;

namespace {

constexpr std::array fields{Field::range, Field::peak_axle_load, Field::peak_beam_stress,
                            Field::apex};
constexpr std::array values{80.0, 5000.0, 2e7, 12.5};

/// The value of a text for those fields, the default scene and a design.
double value_of(const std::string& text) {
  const auto expression = to_expression(text);
  REQUIRE(expression);
  const Scene scene;
  const Design<double> design{0.5, 0.6, 0.9};
  return expression->value({scene, design, fields, values});
}

}  // namespace

TEST_CASE("An expression has the value of its formula") {
  CHECK(value_of("range") == 80);
  CHECK(value_of("r1 + r2") == 0.5 + 0.9);
  CHECK(value_of("r3") == 0.6);
  CHECK(value_of("peak-axle-load / counterweight-mass") == 5000.0 / 5000);
  CHECK(value_of("range - 0.01*peak-beam-stress") == 80 - 0.01 * 2e7);
  CHECK(value_of("abs(range - 100)") == 20);
  CHECK(value_of("-range") == -80);
  CHECK(value_of("-range + 2 * apex") == -80 + 25);
  CHECK(value_of("2 - 3 - 4 + r1 - r1") == 2 - 3 - 4);
  CHECK(value_of("100 / 5 / 2 * range") == 10 * 80);
  CHECK(value_of("1 + 2 * (r1 + r2) / r3") == 1 + 2 * (0.5 + 0.9) / 0.6);
  CHECK(value_of("- (r1 - 2)*-3") == -(0.5 - 2) * -3);
  CHECK(value_of(" range*gravity ") == 80 * 9.8);
  CHECK(value_of("1e2*r1 + .5") == 50.5);
}

TEST_CASE("A hyphen belongs to the longest name that fits, and is a minus elsewhere") {
  CHECK(value_of("apex-1") == 11.5);
  CHECK(value_of("peak-axle-load-apex") == 5000 - 12.5);
  CHECK(value_of("range-r1") == 79.5);
}

TEST_CASE("An operand without a value makes an expression NaN") {
  CHECK(std::isnan(value_of("range + speed")));        // speed is not among the fields
  CHECK(std::isnan(value_of("range * beam-moment")));  // a key that is not set
}

TEST_CASE("An expression tells the fields and keys that it needs, and its text") {
  const auto expression = to_expression("  (range-r1)  / counterweight-mass + apex ");
  REQUIRE(expression);
  CHECK(expression->fields == std::vector{Field::range, Field::apex});
  CHECK(expression->keys == std::vector<std::string>{"scene.counterweight-mass"});
  CHECK(expression->text == "(range-r1) / counterweight-mass + apex");
}

TEST_CASE("The unit is that of all operands of a sum, or of the only one of a product") {
  const auto unit = [](const std::string& text) { return to_expression(text)->unit; };
  CHECK(unit("r1 + r2") == "m");
  CHECK(unit("range - 50") == "m");
  CHECK(unit("2 * r1") == "m");
  CHECK(unit("abs(range - r1)") == "m");
  CHECK(unit("-peak-axle-load") == "N");
  CHECK(unit("r1 / r2").empty());
  CHECK(unit("1 / r1").empty());
  CHECK(unit("r1 / 2") == "m");
  CHECK(unit("range - 0.01*peak-beam-stress").empty());
  CHECK(unit("r1 + r2 * r3").empty());
}

TEST_CASE("A number may have a unit, which is converted to the SI") {
  CHECK(value_of("range - 50 yd") == Approx(80 - 50 * 0.9144));
  CHECK(value_of("abs(range - 100ft)") == Approx(80 - 30.48).epsilon(1e-14));
  CHECK(value_of("1 kN + peak-axle-load") == 6000);
  CHECK(value_of("range / 2 cm") == 4000);
  CHECK(value_of("range * 5 %") == 4);
  CHECK(to_expression("range - 50 yd")->unit == "m");
  CHECK(to_expression("2 ft + 1 m + r1")->unit == "m");
  CHECK(to_expression("range / 2 cm")->unit.empty());
  CHECK(to_expression("30 mph - impact-speed")->unit == "m s-1");
}

TEST_CASE("A number whose unit is not that of the other terms of a sum makes no expression") {
  for (const char* text :
       {"range - 50 lb", "3 s + range", "1 m + 2 kg + range", "range - 50 mx", "range - 50 m/s"})
    CHECK_FALSE(to_expression(text));
}

TEST_CASE("A text that is no formula of known operands is no expression") {
  for (const char* text :
       {"",       " ",           "3",           "1 + 2",      "abs(3)",  "range +",
        "(range", "range)",      "range range", "2 range",    "mass",    "status",
        "steps",  "speed-error", "Range",       "range ^ 2",  "range <", "sin(r1)",
        "r4",     "nan",         "range + nan", "range * inf"})
    CHECK_FALSE(to_expression(text));
}

TEST_CASE("A text that is too long is no expression, however deep its parentheses") {
  for (const std::string text : {"(", "-", "r1+"})
    for (const std::size_t count : {300, 100'000}) {
      std::string formula;
      for (std::size_t i = 0; i < count; ++i) formula += text;
      formula += "r1";
      if (text == "(") formula += std::string(count, ')');
      CHECK(to_expression(formula).has_value() == (count == 300));
    }
}

TEST_CASE(
    "The magnitude of a sum is that of its largest term, of anything else the absolute value") {
  const auto magnitude = [](const std::string& text) {
    const Design<double> design{0.5, 0.6, 0.9};
    return to_expression(text).value().amount({Scene{}, design, fields, values}).magnitude;
  };
  CHECK(magnitude("range") == 80);
  CHECK(magnitude("-range") == 80);
  CHECK(magnitude("range - 79") == 80);
  CHECK(magnitude("abs(range - 100)") == 100);
  CHECK(magnitude("(range - 100) / 2") == 50);
  CHECK(magnitude("(range - 80) * apex") == 80 * 12.5);
  CHECK(magnitude("apex / (r1 - 1)") == 12.5 / 0.5);
}

TEST_CASE("A text with letters that are not ASCII is no expression") {
  for (const std::string text : {"½", "range + ½", "räange", "\xff range"})
    CHECK_FALSE(to_expression(text));
}

TEST_CASE("The negative of an expression has the opposite value, and its text in parentheses") {
  const Expression distance = to_expression("abs(range - 50)").value();
  const Expression opposite = negative(distance);
  CHECK(opposite.text == "-(abs(range - 50))");
  CHECK(value_of(opposite.text) == -30);
  CHECK(opposite.unit == "m");
  CHECK(distance.distance == 1);
  CHECK(opposite.distance == -1);
  CHECK(to_expression(opposite.text)->distance == -1);
  CHECK(to_expression("-(-abs(range - 50))")->distance == 1);
  CHECK(to_expression("abs(range - 50) + apex")->distance == 0);
}

TEST_CASE("An expression that is a field has its meaning; a formula is its own") {
  CHECK(field_of(to_expression(Field::range)) == Field::range);
  CHECK_FALSE(field_of(to_expression("2 * range").value()));
  CHECK(meaning(to_expression(Field::range)) == info(Field::range).meaning);
  CHECK(meaning(to_expression("2 * range").value()) == "2 * range");
}

TEST_CASE(
    "Only the negative of a whole expression is shown as the least, not a sum that looks alike") {
  const ShownObjective least = shown(negative(to_expression("(range) + (apex)").value()));
  CHECK(least.text == "(range) + (apex)");
  CHECK(least.sign == -1);
  CHECK(least.extreme == "least");
  for (const std::string text : {"-(range) + (apex)", "-range", "range"}) {
    CHECK(shown(to_expression(text).value()).text == text);
    CHECK(shown(to_expression(text).value()).sign == 1);
  }
}
