#include "trebsweep/job/key.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/study.hpp"

using namespace trebsweep;
using nlohmann::json;

namespace {

/// A part of the table of refused jobs, which the explorer's tests and the fuzzer share.
json table(const std::string& part) {
  return json::parse(std::ifstream(SOURCE_DIR "/tests/job/refused.json")).at(part);
}

/// The message with which a job is refused: one line that is not long. Empty if it is accepted.
std::string refusal(const std::string& text, const Overrides& overrides = {}) {
  try {
    Study(parse(text, overrides));
    return "";
  } catch (const InputError& error) {
    const std::string message = error.what();
    CHECK(message.size() < 3000);
    CHECK(std::ranges::none_of(message, [](unsigned char c) { return c < ' '; }));
    return message;
  }
}

void check_value(const std::string& key, const std::string& value) {
  INFO(key << " = " << value);
  // Of a list, the message names the wrong word.
  CHECK_THAT(refusal("", {{key, value}}),
             contains(key + " = ") && contains(": must be ") && !contains("left out"));
}

}  // namespace

TEST_CASE("The message about an invalid value names the key and the value, for every key") {
  for (const Key& key : job_keys()) {
    if (key.name == "output.file" || key.name == "assess.scenes" || key.name == "assess.extremes")
      continue;  // any text can be a path
    INFO(key.name);
    CHECK_THROWS_WITH(parse("", {{key.name, "nonsense"}}),
                      contains(key.name + " = nonsense: must be "));
    if (key.name != "optimum.subject-to" && key.name != "optimum.variables")  // may be empty
      CHECK_THROWS_AS(parse("", {{key.name, ""}}), InputError);
  }
}

TEST_CASE("A text that continues after a number is refused, for every number") {
  for (const Key& key : job_keys())
    for (const std::string text : {"0x10", "1e", "1 2", "1,5 kg", "0.01 furlong"})
      if (key.placeholder == "NUMBER") check_value(key.name, text);
}

TEST_CASE("The message about an invalid word of a list names that word only") {
  CHECK_THROWS_WITH(parse("", {{"output.fields", "speed, sped"}}),
                    contains("output.fields = sped: must be one of speed, release-time"));
  CHECK_THROWS_WITH(parse("", {{"output.fields", "speed, range, speed"}}),
                    contains("output.fields = speed: must be listed only once"));
  CHECK_THROWS_WITH(parse("", {{"assess.steppers", "rk4, rk4"}}),
                    contains("assess.steppers = rk4: must be listed only once"));
  const std::string constraints = "speed >= 1, range > 2, apex <= 3";
  CHECK_THROWS_WITH(parse("", {{"optimum.subject-to", constraints}}),
                    contains("optimum.subject-to = range > 2: must be FIELD <= NUMBER"));
  for (const std::string incomplete : {"speed >= 1,", ",speed >= 1", "speed >= 1,,apex <= 3", ","})
    CHECK_THROWS_WITH(parse("", {{"optimum.subject-to", incomplete}}),
                      contains("optimum.subject-to = : must be FIELD <= NUMBER"));
}

TEST_CASE("The message about an invalid value lists the choices or the range") {
  CHECK_THROWS_WITH(parse("", {{"solver.stepper", "leapfrog"}}),
                    contains("solver.stepper = leapfrog: must be one of euler, modified_midpoint, "
                             "rk4, cash_karp54, dopri5, "));
  CHECK_THROWS_WITH(parse("", {{"output.storage", "float16"}}),
                    contains("output.storage = float16: must be one of float64, float32"));
  CHECK_THROWS_WITH(parse("", {{"output.compression", "10"}}),
                    contains("output.compression = 10: must be an integer from 0 to 9"));
  CHECK_THROWS_WITH(parse("", {{"lattice.increment", "0"}}),
                    contains("lattice.increment = 0: must be a number above 0, from 1e-12"));
}

TEST_CASE("A message quotes at most 200 characters of a value") {
  CHECK_THROWS_WITH(parse("", {{"scene.gravity", std::string(201, '9')}}),
                    contains(std::string(200, '9') + "...: must be"));
}

TEST_CASE("The bounds in the message about an angle are allowed values") {
  CHECK_THROWS_WITH(parse("", {{"solver.release-angle", "7"}}), contains("to 6.28318531"));
  CHECK_NOTHROW(parse("", {{"solver.release-angle", "6.28318531"}}));
  CHECK_NOTHROW(parse("", {{"solver.release-angle", "6.283185307179586"}}));
  CHECK_THROWS_WITH(parse("", {{"scene.sling-angle", "4"}}), contains("to 3.14159265"));
  CHECK_NOTHROW(parse("", {{"scene.sling-angle", "3.14159265"}}));
}

TEST_CASE("The numbers of [scene], and no other keys, can have several values") {
  for (const Key& key : job_keys()) {
    INFO(key.name);
    const bool is_scene_number = key.section() == "scene" && key.placeholder == "NUMBER";
    CHECK((key.set_number != nullptr) == is_scene_number);
    Job job;
    if (is_scene_number) {
      key.set(job, "0.3, 0.2");
      REQUIRE(job.outer_axes.size() == 1);
      CHECK(job.outer_axes.front().key == key.name);
      CHECK(job.outer_axes.front().values == std::vector{0.2, 0.3});
      CHECK(key.get(job) == "0.2, 0.3");
    } else if (key.placeholder != "LIST" && key.placeholder != "PATH") {
      CHECK_THROWS_AS(key.set(job, "0.3, 0.2"), InputError);
      if (key.placeholder != "RANGE") CHECK_THROWS_AS(key.set(job, "1:2:1"), InputError);
    }
  }
}

TEST_CASE("A text that is no number is refused for every key that is neither a path nor a list") {
  std::vector<std::string> texts = table("no_numbers");
  texts.emplace_back(5000, '9');
  for (const Key& key : job_keys())
    if (key.placeholder != "PATH" && key.placeholder != "LIST")
      for (const std::string& text : texts) check_value(key.name, text);
}

TEST_CASE("Invalid values are refused") {
  const json rows = table("values");
  REQUIRE(rows.size() > 40);
  for (const json& row : rows)
    for (const std::string key : row[0])
      for (const std::string value : row[1]) check_value(key, value);
}

TEST_CASE("Keys that exclude or require each other are refused, naming one of them") {
  const json rows = table("together");
  REQUIRE(rows.size() > 60);
  for (const json& keys : rows) {
    INFO(keys);
    const std::string message = refusal("", keys.get<Overrides>());
    const auto names = [&](const auto& item) {
      return message.find(item.key()) != std::string::npos;
    };
    CHECK(std::ranges::any_of(keys.items(), names));
  }
}

TEST_CASE("A job file with a mistake is refused") {
  const json texts = table("files");
  REQUIRE(texts.size() > 30);
  for (const std::string text : texts) {
    INFO(text);
    CHECK_FALSE(refusal(text).empty());
  }
}
