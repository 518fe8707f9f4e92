// Refused jobs. The table is also that of the explorer's tests and a part of the fuzzer's seeds.

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/study.hpp"

using namespace trebsweep;
using nlohmann::json;

namespace {

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
  // Of a list, a message names the wrong word.
  CHECK_THAT(refusal("", {{key, value}}),
             contains(key) && contains(": must be ") && !contains("left out"));
}

}  // namespace

TEST_CASE("A text that is no number is refused for every key that is neither a path nor a list") {
  std::vector<std::string> texts = table("no_numbers");
  texts.emplace_back(5000, '9');
  for (const Key& key : job_keys())
    if (key.placeholder != "PATH" && key.placeholder != "LIST")
      for (const std::string& text : texts) check_value(key.name, text);
}

TEST_CASE("Values out of range are refused") {
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
