#include "trebsweep/cli/help.hpp"

#include "support/catch.hpp"
#include "trebsweep/job/key.hpp"

using namespace trebsweep;

TEST_CASE("The help of a command lists the keys that the command uses, and no others") {
  const auto lists = [](Command command, const std::string& key) {
    return command_help(command).find("--" + key + " ") != std::string::npos;
  };
  for (const Key& key : job_keys()) {
    INFO(key.name);
    const std::string section = key.section();
    const bool physics = section == "scene" || section == "solver";
    CHECK(lists(Command::sweep, key.name) == (section != "assess"));
    CHECK(lists(Command::trace, key.name) == physics);
    CHECK(lists(Command::assess, key.name) ==
          (key.name == "output.file" || (section != "output" && section != "optimum")));
    CHECK_FALSE(lists(Command::info, key.name));
  }
}
