#include "trebsweep/cli/command_line.hpp"

#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

CommandLine parse(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "trebsweep");
  return parse_command_line(static_cast<int>(arguments.size()), arguments.data());
}

}  // namespace

TEST_CASE("Keys are options, as --key value or --key=value, before or after the job file") {
  const CommandLine line = parse({"sweep", "--solver.tolerance", "1e-9", "job.cfg", "--overwrite",
                                  "--scene.gravity=-1", "--progress", "none"});
  CHECK(line.command == Command::sweep);
  CHECK(line.file == "job.cfg");
  CHECK(line.overrides == Overrides{{"solver.tolerance", "1e-9"}, {"scene.gravity", "-1"}});
  CHECK(line.overwrite);
  CHECK(line.progress == ProgressStyle::none);
}

TEST_CASE("A sweep takes a time limit; without one it is unlimited") {
  CHECK(parse({"sweep", "j", "--time-limit", "1:30:00"}).time_limit == 5400);
  CHECK(std::isinf(parse({"sweep", "j"}).time_limit));
  CHECK_THROWS_WITH(parse({"sweep", "j", "--time-limit", "soon"}),
                    contains("time-limit = soon: must be a time above 0, in seconds"));
}

TEST_CASE("optimum takes the units of its text, by default those of the SI") {
  CHECK(parse({"optimum", "j"}).units == UnitSystem::si);
  CHECK(parse({"optimum", "j", "--units", "us"}).units == UnitSystem::us);
  CHECK(parse({"optimum", "j", "--units", "deg"}).units == UnitSystem::deg);
  CHECK_THROWS_WITH(parse({"optimum", "j", "--units", "imperial"}),
                    contains("units = imperial: must be one of si, us, deg"));
}

TEST_CASE("A negative number may be a separate argument after its option") {
  CHECK(parse({"sweep", "job.cfg", "--scene.gravity", "-1"}).overrides.at("scene.gravity") == "-1");
}

TEST_CASE("trace takes a design, an interval and --flight") {
  const CommandLine line =
      parse({"trace", "j", "--r1", "0.51", "--r2", "0.91", "--r3", "0.58", "--interval", "0.1"});
  CHECK(line.command == Command::trace);
  CHECK(line.design.r1 == 0.51);
  CHECK(line.design.r2 == 0.91);
  CHECK(line.design.r3 == 0.58);
  CHECK(line.interval == 0.1);
  CHECK_FALSE(line.flight);
  CHECK(parse({"trace", "j", "--r1", "1", "--r2", "1", "--r3", "1", "--flight"}).flight);
}

TEST_CASE("The file has the short option -o; --unset names keys to remove") {
  const CommandLine line =
      parse({"sweep", "j", "-o", "a.h5", "--unset", "solver.tolerance", "--unset", "scene.file"});
  CHECK(line.overrides.at("output.file") == "a.h5");
  CHECK(line.unset == std::vector<std::string>{"solver.tolerance", "scene.file"});
  CHECK_THROWS_WITH(parse({"optimum", "j", "-o", "a.h5"}),
                    contains("-o: unknown option of optimum"));
}

TEST_CASE("Help, a completion and a manual page are texts, with or without a command") {
  CHECK(parse({"help"}).text == parse({"--help"}).text);
  CHECK(parse({"help", "trace"}).text == parse({"trace", "j", "--help"}).text);
  for (const char* const words : {"--help", "completion", "man"}) {
    CHECK(parse({words}).command == Command::text);
    CHECK(parse({words}).text.size() > 1000);
  }
  CHECK(parse({"--version"}).command == Command::version);
  CHECK_THROWS_WITH(parse({"help", "swep"}), contains("swep: unknown command"));
  CHECK_THROWS_WITH(parse({"completion", "sweep"}), contains("sweep: one word too many after"));
}

TEST_CASE("An option of another command is refused") {
  CHECK_THROWS_WITH(
      parse({"trace", "j", "--r1", "1", "--r2", "1", "--r3", "1", "--output.file", "a.txt"}),
      contains("--output.file: unknown option of trace"));
  CHECK_THROWS_WITH(parse({"sweep", "j", "--assess.designs", "3"}),
                    contains("--assess.designs: unknown option of sweep"));
}

TEST_CASE("The message about an invalid command line names what is wrong") {
  CHECK_THROWS_WITH(parse({}), contains("no command"));
  CHECK_THROWS_WITH(parse({"swep"}),
                    contains("swep") && contains("sweep, optimum, trace, assess, info, help"));
  CHECK_THROWS_WITH(parse({"sweep"}), contains("no job file"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "b"}), contains("b"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "--overwrit"}), contains("--overwrit"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "--solver.tol", "1"}), contains("solver.tol"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "--scene.gravity"}), contains("scene.gravity"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "--progress", "loud"}),
                    contains("progress = loud: must be one of auto, bar, lines, none"));
  CHECK_THROWS_WITH(parse({"sweep", "a", "--r1", "1"}), contains("--r1"));
  CHECK_THROWS_WITH(parse({"info", "a", "--json", "--verify"}),
                    contains("--json: must be left out"));
  CHECK_THROWS_WITH(parse({"trace", "a", "--r1", "1"}), contains("--r3"));
  CHECK_THROWS_WITH(parse({"trace", "a", "--r1", "-1", "--r2", "1", "--r3", "1"}),
                    contains("r1 = -1: must be a number above 0"));
  CHECK_THROWS_WITH(parse({"trace", "a", "--r1", "1", "--r2", "1", "--r3", "1", "--interval", "0"}),
                    contains("interval = 0"));
}
