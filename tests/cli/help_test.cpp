#include "trebsweep/cli/help.hpp"

#include <sstream>

#include "support/catch.hpp"
#include "trebsweep/job/key.hpp"

using namespace trebsweep;

namespace {

constexpr std::array commands{Command::sweep, Command::optimum, Command::trace, Command::assess,
                              Command::info};

}  // namespace

TEST_CASE("The help of a command lists the keys that the command uses, and no others") {
  for (const Key& key : job_keys()) {
    INFO(key.name);
    const std::string section = key.section();
    const bool physics = section == "scene" || section == "solver";
    const auto lists = [&](Command command) {
      const bool described = key_help(command).find("--" + key.name + " ") != std::string::npos;
      const std::string help = command_help(command), name = key.name.substr(section.size() + 1);
      const std::string list =
          help.substr(std::min(help.find("\n  " + section + " "), help.size()));
      const bool named = list.find(" " + name + " ") != std::string::npos ||
                         list.find(" " + name + "\n") != std::string::npos;
      if (described) CHECK(named);
      return described;
    };
    CHECK(lists(Command::sweep) == (section != "assess"));
    CHECK(lists(Command::trace) == physics);
    CHECK(lists(Command::assess) ==
          (key.name == "output.file" || (section != "output" && section != "optimum")));
  }
}

TEST_CASE("Help fits a screen of 50 lines of 100 characters") {
  std::vector<std::string> texts{general_help()};
  for (const Command command : commands) texts.push_back(command_help(command));
  for (const std::string& text : texts) {
    INFO(text);
    CHECK(std::ranges::count(text, '\n') <= 50);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) CHECK(line.size() <= 100);
  }
}
