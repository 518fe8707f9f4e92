#include "trebsweep/archive/output_file.hpp"

#include <sys/stat.h>

#include <string>

#include "support/catch.hpp"
#include "support/small_archive.hpp"
#include "support/temporary_directory.hpp"
#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

Job job_in(const fs::path& path) {
  Job job;
  job.output.file = path;
  return job;
}

/// The description of an unfinished sweep of a job in its folder.
void write_unfinished(const Job& job) {
  const fs::path folder = partial_path(job.output.file);
  fs::create_directory(folder);
  write_partial_sweep(folder, {.job = to_text(job),
                               .source = "trebsweep 0",
                               .kernel = "",
                               .numerics = 0,
                               .tile_edge = {1, 1, 1},
                               .replaces = "",
                               .history = {}});
}

constexpr auto both = {
    +[](const Job& job, bool overwrite) { return open_or_resume(job, overwrite); },
    +[](const Job& job, bool overwrite) { return reserve_output(job, overwrite); }};

constexpr auto both_unlocked = {
    +[](const Job& job, bool overwrite) { return open_or_resume(job, overwrite, Reserve::no); },
    +[](const Job& job, bool overwrite) { return reserve_output(job, overwrite, Reserve::no); }};

}  // namespace

TEST_CASE("A path without a file is locked and otherwise left unchanged") {
  const TemporaryDirectory directory;
  for (const auto open : both) {
    {
      const OutputFile output = open(job_in(directory / "a.h5"), false);
      CHECK_FALSE(output.complete);
      CHECK_FALSE(output.partial);
      CHECK(output.lock);
    }
    CHECK(fs::is_empty(directory.path()));
  }
}

TEST_CASE("A path that is only inspected is left as it is, and refused as if it were opened") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory / "a.h5");
  for (const auto inspect : both_unlocked) {
    CHECK_FALSE(inspect(job, false).lock);
    CHECK(fs::is_empty(directory.path()));
  }
  write_unfinished(job);
  CHECK_THROWS_AS(open_or_resume(job, false, Reserve::no), std::runtime_error);  // numerics
  CHECK_NOTHROW(read_partial_sweep(partial_path(job.output.file)));
  CHECK_THROWS_WITH(reserve_output(job, false, Reserve::no), contains("holds an unfinished sweep"));
}

TEST_CASE("What has the name of the folder and is not of this program is never replaced") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory / "a.h5");
  const fs::path folder = partial_path(job.output.file);
  const auto refused = [&](const std::string& word) {
    for (const bool overwrite : {false, true})
      for (const auto& openings : {both, both_unlocked})
        for (const auto open : openings) {
          CHECK_THROWS_AS(open(job, overwrite), InputError);
          CHECK_THROWS_WITH(open(job, overwrite), contains(folder) && contains(word));
        }
  };
  write_file(folder, "precious");
  refused("is a file");
  CHECK(read_file(folder) == "precious");
  fs::rename(folder, directory / "precious.txt");
  fs::create_symlink("precious.txt", folder);
  refused("is a symbolic link");
  fs::remove(folder);
  REQUIRE(mkfifo(folder.c_str(), 0600) == 0);
  refused("is a FIFO");
  fs::remove(folder);

  fs::create_directory(folder);
  write_file(folder / "precious.txt", "precious");
  refused("is not an unfinished sweep");
  CHECK(read_file(folder / "precious.txt") == "precious");
  fs::remove(folder / "precious.txt");
  fs::create_symlink("../precious.txt", folder / lock_name);
  refused("is not an unfinished sweep");
  CHECK(read_file(directory / "precious.txt") == "precious");
  fs::remove(folder / lock_name);
  REQUIRE(mkfifo((folder / lock_name).c_str(), 0600) == 0);
  refused("is not an unfinished sweep");
}

TEST_CASE("What a killed run was creating does not block the next run") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory / "a.h5");
  const fs::path folder = partial_path(job.output.file);
  for (const auto open : both)
    for (const char* file : {"sweep.json.new", "archive.h5", lock_name}) {
      fs::create_directory(folder);
      write_file(folder / file, "{");
      CHECK(open(job, false).lock);
      fs::remove_all(folder);
    }
}

TEST_CASE("A folder with journals but without a description is refused") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory / "a.h5");
  fs::create_directory(directory / "a.h5.partial");
  write_file(directory / "a.h5.partial/0000-00000.journal", "results");
  for (const bool overwrite : {false, true})
    for (const auto open : both)
      CHECK_THROWS_WITH(open(job, overwrite), contains("damaged; move it away"));
  CHECK(read_file(directory / "a.h5.partial/0000-00000.journal") == "results");
}

TEST_CASE("An assessment replaces neither an unfinished sweep nor, unless asked, an archive") {
  const TemporaryDirectory directory;
  const Job job = job_in(directory / "a.h5");
  write_unfinished(job);
  for (const bool overwrite : {false, true})
    CHECK_THROWS_WITH(reserve_output(job, overwrite), contains("holds an unfinished sweep"));
  CHECK_NOTHROW(read_partial_sweep(partial_path(job.output.file)));
  fs::remove_all(partial_path(job.output.file));
  write_all(job.output.file, SmallStudy());
  CHECK_THROWS_WITH(reserve_output(job, false), contains("already exists"));
  const OutputFile output = reserve_output(job, true);
  CHECK(output.replaces == file_identity(job.output.file));
}

TEST_CASE("The complete archive of the job is not locked, and frees the folder of its sweep") {
  const TemporaryDirectory directory;
  const SmallStudy small;
  Job job = small.study.job();
  job.output.file = directory / "a.h5";
  write_all(job.output.file, small);
  for (const bool was_killed : {false, true}) {
    if (was_killed) write_unfinished(job);
    const OutputFile output = open_or_resume(job, false);
    CHECK(output.complete);
    CHECK_FALSE(output.lock);
    CHECK_FALSE(fs::exists(partial_path(job.output.file)));
  }
  CHECK_FALSE(open_or_resume(job, true).complete);
  job.scene.gravity = 9;
  CHECK_THROWS_WITH(open_or_resume(job, false), contains("the archive of another job"));
}

TEST_CASE("An archive that lacks tiles is not taken for the complete one") {
  const TemporaryDirectory directory;
  const SmallStudy small;
  Job job = small.study.job();
  job.output.file = directory / "a.h5";
  write_tiles(job.output.file, small, {0, 3});
  CHECK_THROWS_WITH(open_or_resume(job, false), contains("a snapshot of this job, 3 of"));
  CHECK_FALSE(open_or_resume(job, true).complete);
}

TEST_CASE("A symbolic link is followed, dangling or not") {
  const TemporaryDirectory directory;
  fs::create_directory(directory / "far");
  fs::create_symlink("far/b.h5", directory / "a.h5");
  {
    const OutputFile output = open_or_resume(job_in(directory / "a.h5"), false);
    CHECK(fs::weakly_canonical(output.path) == fs::weakly_canonical(directory / "far/b.h5"));
    CHECK(fs::exists(directory / "far/b.h5.partial/lock"));
  }
  fs::create_symlink("loop.h5", directory / "loop.h5");
  CHECK_THROWS_AS(open_or_resume(job_in(directory / "loop.h5"), false), InputError);
}

TEST_CASE("A file that is not an archive is never replaced") {
  const TemporaryDirectory directory;
  write_file(directory / "notes.txt", "precious");
  for (const bool overwrite : {false, true})
    for (const auto open : both)
      CHECK_THROWS_WITH(open(job_in(directory / "notes.txt"), overwrite),
                        contains("is not an archive"));
  CHECK(read_file(directory / "notes.txt") == "precious");
  CHECK_FALSE(fs::exists(directory / "notes.txt.partial"));
}

TEST_CASE("Paths that cannot name a file are refused with the reason") {
  const TemporaryDirectory directory;
  CHECK_THROWS_WITH(open_or_resume(job_in(directory / "no/a.h5"), false),
                    contains("is not a directory"));
  CHECK_THROWS_WITH(open_or_resume(job_in(directory.path()), false), contains("is a directory"));
  CHECK_THROWS_WITH(open_or_resume(job_in("/dev/null"), true), contains("is a device"));
  CHECK_THROWS_WITH(open_or_resume(job_in("/proc/a.h5"), false),
                    contains("output.file = /proc/a.h5: cannot write in /proc: "));
  // No file system takes 300; of 248, it is the folder next to the file whose name is too long.
  for (const std::size_t length : {248u, 251u, 255u, 300u})
    CHECK_THROWS_WITH(open_or_resume(job_in(directory / std::string(length, 'x')), false),
                      contains("the path is too long"));
  const std::size_t left = 200 - directory.path().string().size() - 1;
  CHECK_THROWS_WITH(open_or_resume(job_in(directory / std::string(left + 1, 'x')), false),
                    contains("too long: 201 characters, at most 200 are allowed"));
  CHECK(open_or_resume(job_in(directory / std::string(left, 'x')), false).lock);
  CHECK(fs::is_empty(directory.path()));
}

TEST_CASE("A FIFO is refused without opening it") {
  const TemporaryDirectory directory;
  REQUIRE(mkfifo((directory / "a.h5").c_str(), 0600) == 0);
  CHECK_THROWS_WITH(open_or_resume(job_in(directory / "a.h5"), true), contains("is a FIFO"));
}

TEST_CASE("Finishing never replaces a file other than the one that existed at the start") {
  const TemporaryDirectory directory;
  OutputFile output = open_or_resume(job_in(directory / "a.h5"), false);
  const fs::path from = unfinished_archive(partial_path(output.path));
  write_file(from, "an archive");
  write_file(output.path, "precious");
  CHECK_THROWS_WITH(finish_output(output), contains("cannot rename"));
  CHECK(read_file(output.path) == "precious");
  output.replaces = file_identity(output.path);
  write_file(output.path, "more precious");
  CHECK_THROWS_WITH(finish_output(output), contains("cannot rename"));
  CHECK(read_file(from) == "an archive");
  output.replaces = file_identity(output.path);
  finish_output(output);
  CHECK(read_file(output.path) == "an archive");
  CHECK(fs::exists(partial_path(output.path) / lock_name));
  output.lock.reset();
  CHECK_FALSE(fs::exists(partial_path(output.path)));
}
