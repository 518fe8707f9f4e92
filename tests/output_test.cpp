#include "trebsweep/output.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "catch.hpp"
#include "trebsweep/error.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

/// An empty folder of this process, gone at the end of its scope.
struct Folder {
  fs::path path = TEST_DIR "/output_of_" + std::to_string(getpid());

  Folder() { fs::create_directory(path); }
  ~Folder() { fs::remove_all(path); }
};

Job job_in(const fs::path& path) {
  Job job;
  job.output.file = path;
  return job;
}

}  // namespace

TEST_CASE("A free place is locked, and otherwise left alone") {
  const Folder folder;
  {
    const Place place = prepare_output(job_in(folder.path / "a.h5"), false);
    CHECK_FALSE(place.complete);
    CHECK_FALSE(place.begun);
    CHECK(place.lock);
  }
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("What is no unfinished sweep is kept unless it may be overwritten") {
  const Folder folder;
  const Job job = job_in(folder.path / "a.h5");
  std::ofstream(folder.path / "a.h5.partial") << "half";
  CHECK_THROWS_WITH(prepare_output(job, false),
                    contains("a.h5.partial") && contains("--overwrite"));
  CHECK(fs::file_size(folder.path / "a.h5.partial") == 4);
  CHECK_FALSE(prepare_output(job, true).begun);
}

TEST_CASE("What is no archive is never replaced") {
  const Folder folder;
  std::ofstream(folder.path / "notes.txt") << "precious";
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(prepare_output(job_in(folder.path / "notes.txt"), overwrite),
                      contains("is no archive"));
  CHECK(fs::file_size(folder.path / "notes.txt") == 8);
}

TEST_CASE("Places that cannot hold a file are refused by name") {
  const Folder folder;
  CHECK_THROWS_WITH(prepare_output(job_in(folder.path / "no" / "a.h5"), false),
                    contains("is no folder"));
  CHECK_THROWS_WITH(prepare_output(job_in(folder.path), false), contains("is a folder"));
  CHECK_THROWS_WITH(prepare_output(job_in(folder.path / std::string(300, 'x')), false),
                    contains("cannot write in") && contains("too long"));
}
