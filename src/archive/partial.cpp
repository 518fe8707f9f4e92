#include "trebsweep/archive/partial.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "trebsweep/archive/regular_file.hpp"
#include "trebsweep/base/mpi.hpp"

namespace trebsweep {
namespace {

namespace fs = std::filesystem;

constexpr const char* description = "sweep.json";
constexpr const char* new_description = "sweep.json.new";
constexpr const char* archive = "archive.h5";
constexpr const char* journal_suffix = ".journal";

}  // namespace

void write_partial_sweep(const fs::path& folder, const PartialSweep& sweep) {
  const nlohmann::ordered_json json{{"program", "trebsweep"},       {"source", sweep.source},
                                    {"kernel", sweep.kernel},       {"numerics", sweep.numerics},
                                    {"tile_edge", sweep.tile_edge}, {"replaces", sweep.replaces},
                                    {"history", sweep.history},     {"job", sweep.job}};
  fs::create_directory(folder);
  const fs::path path = folder / new_description;
  std::ofstream file(path);
  file << json.dump(2) << '\n';
  file.close();
  if (!file) throw std::runtime_error("cannot write " + path.string());
  fs::rename(path, folder / description);
}

PartialSweep read_partial_sweep(const fs::path& folder) {
  const fs::path path = folder / description;
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  try {
    const auto json = nlohmann::json::parse(file);
    PartialSweep sweep{.job = json.at("job"),
                       .source = json.at("source"),
                       .kernel = json.at("kernel"),
                       .numerics = json.at("numerics"),
                       .tile_edge = json.at("tile_edge"),
                       .replaces = json.at("replaces"),
                       .history = json.at("history")};
    if (std::ranges::count(sweep.tile_edge, 0) > 0) throw std::runtime_error("tiles of no extent");
    return sweep;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: damaged: {}", path.string(), error.what()));
  }
}

fs::path journal_path(const fs::path& folder, std::size_t run, int rank) {
  return folder / fmt::format("{:04}-{:05}{}", run, rank, journal_suffix);
}

std::vector<fs::path> journals_in(const fs::path& folder) {
  std::vector<fs::path> journals;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == journal_suffix) journals.push_back(entry.path());
  std::ranges::sort(journals);
  return journals;
}

fs::path unfinished_archive(const fs::path& folder) { return folder / archive; }

bool is_partial_folder(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), {}, [](const fs::directory_entry& entry) {
    const fs::path name = entry.path().filename();
    return entry.is_regular_file() && (name == description || name == new_description ||
                                       name == archive || name.extension() == journal_suffix);
  });
}

void remove_partial(const fs::path& folder) {
  std::error_code ignored;  // a file that remains does no harm
  fs::remove_all(folder, ignored);
}

void require_visible(const fs::path& path, MPI_Comm comm) {
  mpi::on_all(comm, [&] {
    if (!fs::exists(path))
      throw std::runtime_error(fmt::format(
          "rank {} cannot see {}: all ranks must run in the same directory of a shared file system",
          mpi::rank(comm), path.string()));
  });
}

void rename_to_final(const fs::path& from, const fs::path& to, const std::string& replaces) {
  const int file = open(from.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = file >= 0 && fsync(file) == 0;
  if (file >= 0) close(file);
  if (!synced) throw std::runtime_error("cannot sync " + from.string());
  if (fs::exists(fs::symlink_status(to)) && file_identity(to) != replaces)
    throw std::runtime_error(
        fmt::format("cannot rename {} to {}: a file with that name has appeared in the meantime; "
                    "move it away, and the same command will finish the archive",
                    from.string(), to.string()));
  fs::rename(from, to);
}

}  // namespace trebsweep
