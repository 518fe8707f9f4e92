#include "trebsweep/job/config_file.hpp"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

std::map<std::string, std::string> values_of(const std::string& text) {
  return parse_config(text, "my.cfg");
}

}  // namespace

TEST_CASE("Assignments are read with their section, without comments and surrounding spaces") {
  const auto values =
      values_of("# a job\n[scene]\n gravity = 1.6  # on the Moon\n\n[output]\nfile=a b\n");
  REQUIRE(values.size() == 2);
  CHECK(values.at("scene.gravity") == "1.6");
  CHECK(values.at("output.file") == "a b");
}

TEST_CASE("The message about a line that is neither a section nor an assignment has its number") {
  for (const std::string line : {"increment 0.1", "[scene", "[]", "%invalid_line%"})
    CHECK_THROWS_WITH(values_of("[lattice]\n # a comment\n" + line + " # and another\n"),
                      contains("line 3, '" + line + "', is neither [section] nor key = value"));
}

TEST_CASE("The message about a key given twice has both line numbers") {
  CHECK_THROWS_WITH(values_of("[scene]\ngravity = 1\ngravity = 2\n"),
                    contains("my.cfg: scene.gravity is given twice, on lines 2 and 3"));
  CHECK_THROWS_WITH(
      values_of("[scene]\ngravity = 1\n[solver]\nmax-time = 3\n[scene]\ngravity = 1\n"),
      contains("scene.gravity is given twice, on lines 2 and 6"));
  CHECK_THROWS_WITH(values_of("scene.gravity = 5\n[scene]\ngravity = 9\n"),
                    contains("scene.gravity is given twice, on lines 1 and 3"));
}

TEST_CASE("A # inside a value is refused instead of starting a comment") {
  CHECK_THROWS_WITH(values_of("[output]\nfile = run#2.h5\n"),
                    contains("line 2, 'file = run#2.h5', has a # inside a value"));
  CHECK(values_of("[output]\nfile = run  # the second\n").at("output.file") == "run");
  CHECK(values_of("[output]\nfile = run\t#2\n").at("output.file") == "run");
}

TEST_CASE("A message quotes at most 200 characters of a line") {
  try {
    values_of(std::string(5000, 'x'));
    FAIL("accepted");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).size() < 300);
  }
}

TEST_CASE("The message about a file that cannot be read as text names the file and the reason") {
  CHECK_THROWS_WITH(read_job_file("/nowhere/job.cfg"), contains("/nowhere/job.cfg"));
  CHECK_THROWS_WITH(read_job_file("/"), contains("is a directory"));
  CHECK_THROWS_WITH(read_job_file("/dev/null"), contains("is not a regular file"));
  const fs::path file = TEST_DIR "/config_file_test.cfg";
  fs::remove(file);
  REQUIRE(mkfifo(file.c_str(), 0600) == 0);
  CHECK_THROWS_WITH(read_job_file(file), contains("is not a regular file"));
  fs::remove(file);
  std::ofstream(file) << std::string("[scene]\n\0\1\2", 11);
  CHECK_THROWS_WITH(read_job_file(file), contains("is not a text file"));
  std::ofstream(file) << std::string(2 << 20, '#');
  CHECK_THROWS_WITH(read_job_file(file), contains("is longer than 1 MiB"));
  fs::remove(file);
}

TEST_CASE("A byte-order mark is ignored") {
  const fs::path file = TEST_DIR "/config_file_test_bom.cfg";
  std::ofstream(file) << "\xef\xbb\xbf[scene]\ngravity = 9.5\n";
  CHECK(values_of(read_job_file(file)).at("scene.gravity") == "9.5");
  fs::remove(file);
}
