#include "trebsweep/archive/partial.hpp"

#include "support/catch.hpp"
#include "support/temporary_directory.hpp"
#include "trebsweep/archive/file_lock.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/base/version.hpp"
#include "trebsweep/swing/kernel.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

const PartialSweep some_sweep{.job = "[scene]\ngravity = 9.81\n",
                              .source = "trebsweep 1",
                              .kernel = "AVX2 (4 lanes)",
                              .numerics = 3,
                              .tile_edge = {4, 5, 6},
                              .replaces = "inode 7",
                              .history = {"first \"run\"", "second run"}};

}  // namespace

TEST_CASE("A description is read as it was written") {
  const TemporaryDirectory folder;
  write_partial_sweep(folder.path(), some_sweep);
  CHECK(is_partial_folder(folder.path()));
  const PartialSweep read = read_partial_sweep(folder.path());
  CHECK(read.job == some_sweep.job);
  CHECK(read.source == some_sweep.source);
  CHECK(read.kernel == some_sweep.kernel);
  CHECK(read.numerics == 3);
  CHECK(read.tile_edge == some_sweep.tile_edge);
  CHECK(read.replaces == some_sweep.replaces);
  CHECK(read.history == some_sweep.history);
}

TEST_CASE("A damaged description is an error that names its file") {
  const TemporaryDirectory folder;
  write_partial_sweep(folder.path(), some_sweep);
  const fs::path file = folder / "sweep.json";
  const std::string text = read_file(file);
  for (const std::string& damaged :
       {std::string(), text.substr(0, text.size() / 2), std::string("[1, 2]"), std::string("{}")}) {
    write_file(file, damaged);
    CHECK_THROWS_WITH(read_partial_sweep(folder.path()),
                      contains(file.string()) && contains("damaged"));
  }
  fs::remove(file);
  CHECK_THROWS_WITH(read_partial_sweep(folder.path()), contains("cannot read"));
}

TEST_CASE("A folder with other files is not that of a sweep") {
  const TemporaryDirectory folder;
  CHECK(is_partial_folder(folder.path()));
  write_partial_sweep(folder.path(), some_sweep);
  write_file(journal_path(folder.path(), 0, 3), "a record");
  write_file(unfinished_archive(folder.path()), "an archive");
  write_file(folder / lock_name, "a process");
  CHECK(is_partial_folder(folder.path()));
  CHECK(journals_in(folder.path()) == std::vector{folder / "0000-00003.journal"});
  write_file(folder / "notes.txt", "precious");
  CHECK_FALSE(is_partial_folder(folder.path()));
}

TEST_CASE("Only the lock remains in a folder that is cleared") {
  const TemporaryDirectory folder;
  write_partial_sweep(folder.path(), some_sweep);
  write_file(journal_path(folder.path(), 0, 3), "a record");
  write_file(folder / lock_name, "a process");
  clear_partial(folder.path());
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 1);
  CHECK(read_file(folder / lock_name) == "a process");
}

TEST_CASE("A folder that cannot be cleared keeps its description") {
  const TemporaryDirectory folder;
  write_partial_sweep(folder.path(), some_sweep);
  fs::create_directories(folder / "0000-00003.journal" / "not empty");
  CHECK_THROWS_WITH(clear_partial(folder.path()), contains("cannot remove"));
  CHECK(read_partial_sweep(folder.path()).job == some_sweep.job);
}

TEST_CASE("Jobs are the same if their results are, whatever their file and assessment") {
  const Job job;
  Job other;
  other.output.file = "another.h5";
  CHECK(is_same_job(job, to_text(other)));
  for (const char* text : {"[solver]\ncheck = no\n", "[scene]\ngravity = 9\n",
                           "[output]\nfields = speed\n", "[optimum]\nrefine = true\n"})
    CHECK_FALSE(is_same_job(job, text));
  CHECK_FALSE(is_same_job(job, "[scene]\nno-such-key = 1\n"));
}

TEST_CASE("An unfinished sweep is resumed only by its job and the same arithmetic") {
  const Job job;
  const PartialSweep same{.job = to_text(job),
                          .source = "trebsweep 1",
                          .kernel = std::string(instruction_set()),
                          .numerics = numerics_version,
                          .tile_edge = {4, 5, 6},
                          .replaces = "",
                          .history = {}};
  CHECK_NOTHROW(require_resumable(job, "a.partial", same));
  PartialSweep other = same;
  other.job = "[solver]\ncheck = no\n";
  CHECK_THROWS_AS(require_resumable(job, "a.partial", other), InputError);
  CHECK_THROWS_WITH(require_resumable(job, "a.partial", other),
                    contains("solver.check = no there, yes here"));
  other = same;
  ++other.numerics;
  CHECK_THROWS_WITH(require_resumable(job, "a.partial", other), contains("with numerics"));
}
