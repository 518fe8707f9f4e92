#include "trebsweep/archive/output_state.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

/// An empty directory of this process, removed by the destructor.
struct TemporaryDirectory {
  fs::path path = TEST_DIR "/output_of_" + std::to_string(getpid());

  TemporaryDirectory() { fs::create_directory(path); }
  ~TemporaryDirectory() { fs::remove_all(path); }
};

Job job_in(const fs::path& path) {
  Job job;
  job.output.file = path;
  return job;
}

}  // namespace

TEST_CASE("A path without a file is locked and otherwise left unchanged") {
  const TemporaryDirectory directory;
  {
    const OutputState state = open_or_resume(job_in(directory.path / "a.h5"), false);
    CHECK_FALSE(state.complete);
    CHECK_FALSE(state.partial);
    CHECK(state.lock);
  }
  CHECK(fs::is_empty(directory.path));
}

TEST_CASE("A file or folder that is not of this program is never replaced") {
  for (const std::string suffix : {".partial", ".new", ".lock"}) {
    const TemporaryDirectory directory;
    const Job job = job_in(directory.path / "a.h5");
    const fs::path other = job.output.file + suffix;
    const auto refused = [&](const std::string& word) {
      for (const bool overwrite : {false, true})
        for (const auto open : {open_or_resume, reserve_output}) {
          if (suffix == ".new" && open == open_or_resume && word == "exists and ") continue;
          CHECK_THROWS_AS(open(job, overwrite), InputError);
          CHECK_THROWS_WITH(open(job, overwrite), contains(other) && contains(word));
        }
    };
    std::ofstream(other) << "precious";
    refused(suffix == ".partial" ? "is a file" : "exists and ");
    CHECK(fs::file_size(other) == 8);
    fs::rename(other, directory.path / "precious.txt");
    fs::create_symlink("precious.txt", other);
    refused("is a symbolic link");
    fs::remove(other);
    fs::create_directory(other);
    std::ofstream(other / "precious.txt") << "precious";
    refused(suffix == ".partial" ? "unfinished sweep" : "is a directory");
    fs::remove_all(other);
    REQUIRE(mkfifo(other.c_str(), 0600) == 0);
    refused("is a FIFO");
  }
}

TEST_CASE("What a killed run was creating does not block the next run") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory.path / "a.h5");
  fs::create_directory(directory.path / "a.h5.partial");
  std::ofstream(directory.path / "a.h5.partial/sweep.json.new") << "{";
  CHECK(open_or_resume(job, false).lock);
  fs::remove_all(directory.path / "a.h5.partial");

  const std::string hdf5 = "\x89HDF\r\n\x1a\nand more";
  for (const std::string& start : {std::string(), hdf5}) {
    std::ofstream(directory.path / "a.h5.new") << start;
    std::ofstream(directory.path / "a.h5.lock") << "trebsweep lock: process 1 on nowhere";
    CHECK(reserve_output(job, false).lock);
  }
  // Without the stale lock of a killed run, the file may belong to somebody else.
  std::ofstream(directory.path / "a.h5.new") << hdf5;
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(reserve_output(job, overwrite), contains("not left by an interrupted run"));
}

TEST_CASE("A folder with journals but without a description is refused") {
  const TemporaryDirectory directory;
  fs::create_directory(directory.path / "a.h5.partial");
  std::ofstream(directory.path / "a.h5.partial/0000-00000.journal") << "results";
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / "a.h5"), overwrite),
                      contains("damaged; move it away"));
}

TEST_CASE("A symbolic link is followed, dangling or not") {
  const TemporaryDirectory directory;
  fs::create_directory(directory.path / "far");
  fs::create_symlink("far/b.h5", directory.path / "a.h5");
  {
    const OutputState state = open_or_resume(job_in(directory.path / "a.h5"), false);
    CHECK(fs::weakly_canonical(state.path) ==
          fs::weakly_canonical(directory.path / "far" / "b.h5"));
    CHECK(fs::exists(directory.path / "far" / "b.h5.lock"));
  }
  fs::create_symlink("loop.h5", directory.path / "loop.h5");
  CHECK_THROWS_AS(open_or_resume(job_in(directory.path / "loop.h5"), false), InputError);
}

TEST_CASE("A file that is not an archive is never replaced") {
  const TemporaryDirectory directory;
  std::ofstream(directory.path / "notes.txt") << "precious";
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / "notes.txt"), overwrite),
                      contains("is not an archive"));
  CHECK(fs::file_size(directory.path / "notes.txt") == 8);
}

TEST_CASE("Paths that cannot name a file are refused with the reason") {
  const TemporaryDirectory directory;
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / "no" / "a.h5"), false),
                    contains("is not a directory"));
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path), false), contains("is a directory"));
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / std::string(300, 'x')), false),
                    contains("cannot write in") && contains("too long"));
  // The name itself is short enough, those of the files next to it are not.
  for (const std::size_t length : {244u, 248u, 251u, 255u})
    CHECK_THROWS_AS(open_or_resume(job_in(directory.path / std::string(length, 'x')), false),
                    InputError);
  const std::size_t left = 200 - directory.path.string().size() - 1;
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / std::string(left + 1, 'x')), false),
                    contains("too long: 201 characters, at most 200 are allowed"));
  CHECK(open_or_resume(job_in(directory.path / std::string(left, 'x')), false).lock);
  CHECK(fs::is_empty(directory.path));
}

TEST_CASE("A FIFO is refused without opening it") {
  const TemporaryDirectory directory;
  REQUIRE(mkfifo((directory.path / "a.h5").c_str(), 0600) == 0);
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path / "a.h5"), true), contains("is a FIFO"));
}
