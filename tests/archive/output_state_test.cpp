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
    const OutputState place = open_or_resume(job_in(folder.path / "a.h5"), false);
    CHECK_FALSE(place.complete);
    CHECK_FALSE(place.begun);
    CHECK(place.lock);
  }
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("What is no unfinished sweep is never replaced") {
  for (const std::string suffix : {".partial", ".partial.new", ".lock"}) {
    const Folder folder;
    const Job job = job_in(folder.path / "a.h5");
    const fs::path other = job.output.file + suffix;
    const auto refused = [&](const std::string& word) {
      for (const bool overwrite : {false, true}) {
        CHECK_THROWS_AS(open_or_resume(job, overwrite), InputError);
        CHECK_THROWS_WITH(open_or_resume(job, overwrite), contains(other) && contains(word));
      }
    };
    std::ofstream(other) << "precious";
    refused("is there and ");
    CHECK(fs::file_size(other) == 8);
    fs::rename(other, folder.path / "precious.txt");
    fs::create_symlink("precious.txt", other);
    refused("is a symbolic link");
    fs::remove(other);
    fs::create_directory(other);
    refused("is a folder");
    fs::remove(other);
    REQUIRE(mkfifo(other.c_str(), 0600) == 0);
    refused("is a FIFO");
  }
}

TEST_CASE("What a killed run left of a file that it was creating may be replaced") {
  const Folder folder;
  const Job job = job_in(folder.path / "a.h5");
  const std::string hdf5 = "\x89HDF\r\n\x1a\nand more";
  for (const std::string& start : {std::string(), hdf5}) {
    std::ofstream(folder.path / "a.h5.partial.new") << start;
    std::ofstream(folder.path / "a.h5.lock") << "trebsweep lock: process 1 on nowhere";
    CHECK(open_or_resume(job, false).lock);
  }
  // Without the lock of a killed run, it is somebody else's.
  std::ofstream(folder.path / "a.h5.partial.new") << hdf5;
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(open_or_resume(job, overwrite), contains("not left by an interrupted run"));
}

TEST_CASE("A link is followed, dangling or not") {
  const Folder folder;
  fs::create_directory(folder.path / "far");
  fs::create_symlink("far/b.h5", folder.path / "a.h5");
  {
    const OutputState place = open_or_resume(job_in(folder.path / "a.h5"), false);
    CHECK(fs::weakly_canonical(place.path) == fs::weakly_canonical(folder.path / "far" / "b.h5"));
    CHECK(fs::exists(folder.path / "far" / "b.h5.lock"));
  }
  fs::create_symlink("loop.h5", folder.path / "loop.h5");
  CHECK_THROWS_AS(open_or_resume(job_in(folder.path / "loop.h5"), false), InputError);
}

TEST_CASE("What is no archive is never replaced") {
  const Folder folder;
  std::ofstream(folder.path / "notes.txt") << "precious";
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(open_or_resume(job_in(folder.path / "notes.txt"), overwrite),
                      contains("is no archive"));
  CHECK(fs::file_size(folder.path / "notes.txt") == 8);
}

TEST_CASE("Places that cannot hold a file are refused by name") {
  const Folder folder;
  CHECK_THROWS_WITH(open_or_resume(job_in(folder.path / "no" / "a.h5"), false),
                    contains("is no folder"));
  CHECK_THROWS_WITH(open_or_resume(job_in(folder.path), false), contains("is a folder"));
  CHECK_THROWS_WITH(open_or_resume(job_in(folder.path / std::string(300, 'x')), false),
                    contains("cannot write in") && contains("too long"));
  // Names that are short enough, while those of the files next to them are not.
  for (const std::size_t length : {244u, 248u, 251u, 255u})
    CHECK_THROWS_AS(open_or_resume(job_in(folder.path / std::string(length, 'x')), false),
                    InputError);
  const std::size_t left = 200 - folder.path.string().size() - 1;
  CHECK_THROWS_WITH(open_or_resume(job_in(folder.path / std::string(left + 1, 'x')), false),
                    contains("too long: 201 characters, at most 200 are allowed"));
  CHECK(open_or_resume(job_in(folder.path / std::string(left, 'x')), false).lock);
  CHECK(fs::is_empty(folder.path));
}

TEST_CASE("A FIFO is refused instead of waited for") {
  const Folder folder;
  REQUIRE(mkfifo((folder.path / "a.h5").c_str(), 0600) == 0);
  CHECK_THROWS_WITH(open_or_resume(job_in(folder.path / "a.h5"), true), contains("is a FIFO"));
}
