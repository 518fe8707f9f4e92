#include "trebsweep/archive/partial.hpp"

#include <fstream>

#include "support/catch.hpp"
#include "trebsweep/archive/regular_file.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

/// A folder in the directory of the tests, removed by the destructor.
struct TemporaryFolder {
  fs::path path;

  explicit TemporaryFolder(const std::string& name) : path(fs::path(TEST_DIR) / name) {}
  ~TemporaryFolder() { fs::remove_all(path); }
};

const PartialSweep some_sweep{.job = "[scene]\ngravity = 9.81\n",
                              .source = "trebsweep 1",
                              .kernel = "AVX2 (4 lanes)",
                              .numerics = 3,
                              .tile_edge = {4, 5, 6},
                              .replaces = "inode 7",
                              .history = {"first \"run\"", "second run"}};

}  // namespace

TEST_CASE("A description is read as it was written") {
  const TemporaryFolder folder("described.partial");
  write_partial_sweep(folder.path, some_sweep);
  CHECK(is_partial_folder(folder.path));
  const PartialSweep read = read_partial_sweep(folder.path);
  CHECK(read.job == some_sweep.job);
  CHECK(read.source == some_sweep.source);
  CHECK(read.kernel == some_sweep.kernel);
  CHECK(read.numerics == 3);
  CHECK(read.tile_edge == some_sweep.tile_edge);
  CHECK(read.replaces == some_sweep.replaces);
  CHECK(read.history == some_sweep.history);
}

TEST_CASE("A damaged description is an error that names its file") {
  const TemporaryFolder folder("damaged.partial");
  write_partial_sweep(folder.path, some_sweep);
  const fs::path file = folder.path / "sweep.json";
  std::string text(fs::file_size(file), ' ');
  std::ifstream(file).read(text.data(), static_cast<std::streamsize>(text.size()));
  for (const std::string& damaged :
       {std::string(), text.substr(0, text.size() / 2), std::string("[1, 2]"), std::string("{}")}) {
    std::ofstream(file) << damaged;
    CHECK_THROWS_WITH(read_partial_sweep(folder.path),
                      contains(file.string()) && contains("damaged"));
  }
  fs::remove(file);
  CHECK_THROWS_WITH(read_partial_sweep(folder.path), contains("cannot read"));
}

TEST_CASE("A folder with other files is not that of a sweep") {
  const TemporaryFolder folder("other.partial");
  write_partial_sweep(folder.path, some_sweep);
  std::ofstream(journal_path(folder.path, 0, 3)) << "a record";
  std::ofstream(unfinished_archive(folder.path)) << "an archive";
  CHECK(is_partial_folder(folder.path));
  CHECK(journals_in(folder.path) == std::vector{folder.path / "0000-00003.journal"});
  std::ofstream(folder.path / "notes.txt") << "precious";
  CHECK_FALSE(is_partial_folder(folder.path));
}

TEST_CASE("Finishing never replaces a file other than the one that existed at the start") {
  const TemporaryFolder folder("finished.partial");
  fs::create_directory(folder.path);
  const fs::path from = folder.path / "archive.h5", to = folder.path / "a.h5";
  std::ofstream(from) << "an archive";
  std::ofstream(to) << "precious";
  CHECK_THROWS_WITH(rename_to_final(from, to, ""), contains("cannot rename"));
  CHECK(fs::file_size(to) == 8);
  const std::string identity = file_identity(to);
  std::ofstream(to, std::ios::app) << "!";
  CHECK_THROWS_WITH(rename_to_final(from, to, identity), contains("cannot rename"));
  rename_to_final(from, to, file_identity(to));
  CHECK(fs::file_size(to) == 10);
  CHECK_FALSE(fs::exists(from));
}
