#include "trebsweep/archive/archive_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <system_error>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/child_process.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {
namespace {

[[noreturn]] void damaged(const std::string& why) { throw std::runtime_error("damaged: " + why); }

hdf5::File open_file(const std::filesystem::path& path) {
  hdf5::silence();
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open it"};
}

/// Whether a text can be shown: damage can be anything, and a terminal obeys control characters.
bool is_text(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](unsigned char c) { return std::iscntrl(c) && c != '\n' && c != '\t'; });
}

/// A text attribute that can be shown.
std::string read_text(hid_t file, const std::string& name) {
  std::string text = hdf5::read_text_attribute(file, name);
  if (!is_text(text)) damaged(name + " is no text");
  return text;
}

std::size_t read_edge(hid_t tile_done, const char* name, std::size_t extent) {
  const double edge = hdf5::read_number_attribute(tile_done, name);
  if (!(edge >= 1 && edge <= static_cast<double>(extent))) damaged("impossible tiles");
  return static_cast<std::size_t>(edge);
}

/// The sum of the first rows, as many as are done.
Tally read_tally(hid_t file, std::uint64_t tiles, std::uint64_t done, std::uint64_t cells) {
  const auto values = hdf5::read_numbers(file, "tile_tally");
  if (values.size() != tiles * tally_columns.size()) damaged("not a tally per tile");
  Tally sum;
  for (std::uint64_t t = 0; t < done; ++t) {
    TallyRow row;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(t * row.size()), row.size(),
                row.begin());
    const Tally tally = to_tally(row);
    if (tally.designs() == 0) damaged(fmt::format("tile {} is done without a design", t));
    if (tally.best_speed >= 0 && tally.best_cell >= cells)
      damaged(fmt::format("tile {} has its best shot outside the lattice", t));
    sum.add(tally);
  }
  return sum;
}

/// How many tiles from the first on are done.
std::uint64_t count_done(const std::vector<double>& done) {
  return static_cast<std::uint64_t>(
      std::find_if(done.begin(), done.end(), [](double flag) { return flag != 1; }) - done.begin());
}

ArchiveHeader read_archived(const std::filesystem::path& path) {
  const hdf5::File file = open_file(path);
  if (!read_text(file, "source").starts_with("trebsweep ")) damaged("made by another program");
  ArchiveHeader archived{.job = read_text(file, "job"),
                         .is_sweep = H5Lexists(file, "tile_done", H5P_DEFAULT) > 0,
                         .replaces = {}};
  if (archived.is_sweep) {
    const auto done = hdf5::read_numbers(file, "tile_done");
    archived.tiles = done.size();
    archived.tiles_done = count_done(done);
    if (H5Aexists(file, "replaces") > 0) archived.replaces = read_text(file, "replaces");
  } else if (H5Lexists(file, "accuracy", H5P_DEFAULT) <= 0) {
    damaged("neither a sweep nor an assessment");
  }
  return archived;
}

AssessmentContents read_assessment_here(const std::filesystem::path& path) {
  const hdf5::File file = open_file(path);
  AssessmentContents contents{.job = read_text(file, "job"),
                              .source = read_text(file, "source"),
                              .history = read_text(file, "history"),
                              .tables = {}};
  for (const std::string& name : hdf5::link_names(file))
    if (is_text(name)) contents.tables.push_back(name);
  return contents;
}

/// Throws where a map that the archive's job asks for is missing or has another extent.
void check_maps(hid_t file, const ArchiveContents& contents) {
  const auto& [r1, r3, r2] = contents.axes;
  const std::vector<hsize_t> extents{r1.size(), r3.size(), r2.size()};
  for (const Field field : parse_job(contents.job, "archive", {}).output.fields)
    if (hdf5::extents(hdf5::open_dataset(file, dataset_name(field))) != extents)
      damaged(fmt::format("map {} does not fit its axes", dataset_name(field)));
}

ArchiveContents read(const std::filesystem::path& path) {
  const hdf5::File file = open_file(path);
  const double format = hdf5::read_number_attribute(file, "format_version");
  if (format != archive_format)
    throw std::runtime_error(
        fmt::format("format_version {}, while this program reads {}", format, archive_format));
  ArchiveContents contents;
  contents.job = read_text(file, "job");
  contents.scene = read_text(file, "scene");
  contents.source = read_text(file, "source");
  contents.kernel = read_text(file, "kernel");
  try {
    contents.history = read_text(file, "history");
  } catch (const std::runtime_error&) {
    // A run was killed while it was written: not worth the rest.
  }
  contents.axes = {hdf5::read_numbers(file, "r1"), hdf5::read_numbers(file, "r3"),
                   hdf5::read_numbers(file, "r2")};
  const hdf5::Dataset tile_done(H5Dopen2(file, "tile_done", H5P_DEFAULT), "open tile_done");
  std::uint64_t cells = 1;
  constexpr std::array edges{"edge_r1", "edge_r3", "edge_r2"};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t extent = contents.axes[d].size();
    contents.tile_edge[d] = read_edge(tile_done, edges[d], extent);
    cells *= extent;
  }
  const auto done = hdf5::read_numbers(file, "tile_done");
  contents.tiles = done.size();
  contents.tiles_done = count_done(done);
  contents.tally = read_tally(file, contents.tiles, contents.tiles_done, cells);
  check_maps(file, contents);
  return contents;
}

/// Calls f in a child first: HDF5 crashes on some damaged files, and hangs on others.
template <class F>
auto try_first(const std::filesystem::path& path, F f) {
  constexpr unsigned working = 10, waiting = 60;  // s: a file system may be slow
  try {
    if (!completes_in_child([&] { f(); }, working, waiting)) damaged("HDF5 fails on it");
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "cannot read " + path.string());
  }
  return f();
}

}  // namespace

ArchiveContents read_contents(const std::filesystem::path& path) {
  return try_first(path, [&] { return read(path); });
}

std::optional<ArchiveHeader> read_archive_header(const std::filesystem::path& path) {
  try {
    return try_first(path, [&] { return read_archived(path); });
  } catch (const std::system_error&) {
    throw;  // nothing is known of the file
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

AssessmentContents read_assessment(const std::filesystem::path& path) {
  return try_first(path, [&] { return read_assessment_here(path); });
}

}  // namespace trebsweep
