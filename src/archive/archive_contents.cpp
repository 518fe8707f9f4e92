#include "trebsweep/archive/archive_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "trebsweep/archive/archive_format.hpp"
#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/untrusted_file.hpp"
#include "trebsweep/job/job.hpp"

namespace trebsweep {
namespace {

std::size_t read_edge(hid_t tile_done, const char* name, std::size_t extent) {
  const double edge = hdf5::read_number_attribute(tile_done, name);
  if (!(edge >= 1 && edge <= static_cast<double>(extent)))
    untrusted::fail(fmt::format("impossible tile extent {} = {}", name, edge));
  return static_cast<std::size_t>(edge);
}

/// The sum of the tallies of the first `done` tiles.
Tally read_tally(hid_t file, std::uint64_t tiles, std::uint64_t done, std::uint64_t cells) {
  const auto values = hdf5::read_numbers(file, "tile_tally");
  constexpr std::size_t columns = tally_columns.size();
  // Archives of format version 3 lack the last columns, the first cell of each status.
  constexpr std::size_t former_columns = columns - status_names.size();
  const bool is_former = values.size() == tiles * former_columns;
  if (values.size() != tiles * columns && !is_former)
    untrusted::fail("tile_tally does not have one row per tile");
  const std::size_t stored = is_former ? former_columns : columns;
  Tally sum;
  for (std::uint64_t t = 0; t < done; ++t) {
    TallyRow row;
    row.fill(-1);  // no cell
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(t * stored), stored, row.begin());
    const Tally tally = to_tally(row);
    if (tally.designs() == 0)
      untrusted::fail(fmt::format("tile {} is marked done but has no designs", t));
    if (tally.best_speed >= 0 && tally.best_cell >= cells)
      untrusted::fail(fmt::format("the best design of tile {} lies outside the lattice", t));
    for (const std::uint64_t first : tally.first_cells)
      if (first != no_cell && first >= cells)
        untrusted::fail(fmt::format("a design of tile {} lies outside the lattice", t));
    sum.add(tally);
  }
  return sum;
}

/// The measured error of a complete sweep, or none if it was not measured.
std::optional<MeasuredError> read_error(hid_t file) {
  const auto read = [&](const char* name) { return hdf5::read_number_attribute(file, name); };
  // Archives of format version 3 lack these attributes.
  if (H5Aexists(file, "error_designs") <= 0 || !(read("error_designs") > 0)) return std::nullopt;
  return MeasuredError{.median = read("error_median"),
                       .largest = read("error_largest"),
                       .at_optimum = read("error_at_optimum"),
                       .designs = static_cast<std::uint64_t>(read("error_designs"))};
}

/// Throws if a map that the archive's job asks for is missing or has another extent.
void check_maps(hid_t file, const ArchiveContents& contents) {
  const auto& [r1, r3, r2] = contents.axes;
  const std::vector<hsize_t> extents{r1.size(), r3.size(), r2.size()};
  for (const Field field : parse_job(contents.job, "archive", {}).output.fields)
    if (hdf5::extents(hdf5::open_dataset(file, dataset_name(field))) != extents)
      untrusted::fail(
          fmt::format("the extent of map {} is not that of the axes", dataset_name(field)));
}

ArchiveContents read(const std::filesystem::path& path) {
  const hdf5::File file = untrusted::open(path);
  const double format = hdf5::read_number_attribute(file, "format_version");
  if (format != format_version)
    throw std::runtime_error(
        fmt::format("format_version is {}, this program reads {}", format, format_version));
  ArchiveContents contents;
  contents.job = untrusted::read_text(file, "job");
  contents.scene = untrusted::read_text(file, "scene");
  contents.source = untrusted::read_text(file, "source");
  contents.kernel = untrusted::read_text(file, "kernel");
  try {
    contents.history = untrusted::read_text(file, "history");
  } catch (const std::runtime_error&) {
    // A run was killed while writing it: the maps are worth more than the history.
  }
  contents.axes = {hdf5::read_numbers(file, "r1"), hdf5::read_numbers(file, "r3"),
                   hdf5::read_numbers(file, "r2")};
  const hdf5::Dataset tile_done = hdf5::open_dataset(file, "tile_done");
  std::uint64_t cells = 1;
  constexpr std::array edges{"edge_r1", "edge_r3", "edge_r2"};
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t extent = contents.axes[d].size();
    contents.tile_edge[d] = read_edge(tile_done, edges[d], extent);
    cells *= extent;
  }
  const auto done = hdf5::read_numbers(file, "tile_done");
  contents.tiles = done.size();
  contents.tiles_done = untrusted::count_done(done);
  contents.tally = read_tally(file, contents.tiles, contents.tiles_done, cells);
  contents.error = read_error(file);
  check_maps(file, contents);
  return contents;
}

}  // namespace

ArchiveContents read_contents(const std::filesystem::path& path) {
  return untrusted::read(path, [&] { return read(path); });
}

}  // namespace trebsweep
