#include "trebsweep/archive/archive_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cctype>
#include <stdexcept>

#include "trebsweep/archive/layout.hpp"

namespace trebsweep {
namespace {

[[noreturn]] void fail(const std::string& why) { throw std::runtime_error("damaged: " + why); }

/// Whether a text can be printed. A damaged one may hold control characters, which a terminal would
/// interpret.
bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(),
                      [](unsigned char c) { return std::iscntrl(c) && c != '\n' && c != '\t'; });
}

std::string read_text(hid_t object, const std::string& name) {
  std::string text = hdf5::read_text_attribute(object, name);
  if (!is_printable(text)) fail("attribute " + name + " is not text");
  return text;
}

bool has(hid_t file, const char* name) { return H5Lexists(file, name, H5P_DEFAULT) > 0; }

ArchiveHeader read_header(hid_t file) {
  ArchiveHeader header{.job = read_text(file, "job"),
                       .source = read_text(file, "source"),
                       .history = read_text(file, "history"),
                       .tables = {}};
  if (!header.source.starts_with("trebsweep ")) fail("created by another program");
  if (has(file, "tile_block")) return header;
  if (!has(file, "accuracy")) fail("neither a sweep nor an assessment");
  for (const std::string& name : hdf5::link_names(file))
    if (is_printable(name)) header.tables.push_back(name);
  return header;
}

/// A table with a row for each tile.
struct Table {
  std::vector<std::string> columns;
  std::vector<std::uint64_t> values;

  std::span<const std::uint64_t> row(std::uint64_t tile) const {
    return std::span(values).subspan(tile * columns.size(), columns.size());
  }
};

/// Throws unless the table has the given number of rows; 0 stands for any number.
Table read_table(hid_t file, const std::string& name, std::uint64_t rows) {
  Table table;
  const std::string columns = read_text(hdf5::open_dataset(file, name), "columns");
  boost::split(table.columns, columns, boost::is_any_of(" "));
  table.values = hdf5::read_numbers<std::uint64_t>(file, name);
  const std::uint64_t size = rows * table.columns.size();
  if (rows > 0 ? table.values.size() != size : table.values.size() % table.columns.size() != 0)
    fail(name + " does not have a row for each tile");
  return table;
}

/// The tiles of an archive. Throws if one is not within the maps.
std::vector<Tile> read_tiles(hid_t file, std::uint64_t scenes, const Index3& box) {
  const Table table = read_table(file, "tile_block", 0);
  if (table.columns.size() != block_columns.size()) fail("tile_block has other columns");
  std::vector<Tile> tiles(table.values.size() / block_columns.size());
  for (std::uint64_t t = 0; t < tiles.size(); ++t) {
    const auto row = table.row(t);
    auto& [first, count] = tiles[t].block;
    tiles[t].scene = row[0];
    bool possible = row[0] < scenes;
    for (std::size_t d = 0; d < 3; ++d) {
      first[d] = row[1 + d];
      count[d] = row[4 + d];
      possible = possible && first[d] < box[d] && 0 < count[d] && count[d] <= box[d] - first[d];
    }
    if (!possible) fail(fmt::format("tile {} lies outside the lattice", t));
  }
  if (tiles.empty()) fail("it has no tiles");
  return tiles;
}

/// The optima of the scenes of a study, whose outer axes have the given extents.
std::vector<BestDesign> read_optima(hid_t file, std::span<const hsize_t> outer,
                                    std::uint64_t scenes) {
  std::vector<BestNumbers> numbers(scenes);
  for (std::size_t d = 0; d < best_names.size(); ++d) {
    const std::string name(best_names[d]);
    if (!std::ranges::equal(hdf5::extents(hdf5::open_dataset(file, name)), outer))
      fail("the extent of " + name + " is not that of the outer axes");
    const auto values = hdf5::read_numbers(file, name);
    for (std::uint64_t s = 0; s < scenes; ++s) numbers[s][d] = values[s];
  }
  std::vector<BestDesign> optima;
  for (const BestNumbers& best : numbers) optima.push_back(to_best_design(best));
  return optima;
}

Summary read_attributes(hid_t file) {
  const auto read = [&](std::string_view name) {
    return hdf5::read_number_attribute(file, std::string(name));
  };
  const auto count = [&](std::string_view name) {
    const double value = read(name);
    if (!(value >= 0 && value < 9e15)) fail(fmt::format("{} is {}", name, value));
    return static_cast<std::uint64_t>(value);
  };
  BestNumbers best;
  std::ranges::transform(best_names, best.begin(), read);
  Summary summary;
  summary.optima = {to_best_design(best)};
  summary.tally.steps = count("steps");
  summary.tally.lane_steps = count("lane_steps");
  summary.tally.integration_seconds = read("integration_seconds");
  summary.tally.sweep_seconds = read("sweep_seconds");
  if (const std::uint64_t designs = count("error_designs"); designs > 0)
    summary.error = MeasuredError{.median = read("error_median"),
                                  .largest = read("error_largest"),
                                  .at_optimum = read("error_at_optimum"),
                                  .designs = designs};
  return summary;
}

/// Adds the designs of the tiles to the summary.
void read_designs(hid_t file, ArchiveContents& contents) {
  const Table designs = read_table(file, "tile_designs", contents.tiles.size());
  StatusCounts& statuses = contents.summary.tally.statuses;
  if (designs.columns.size() != statuses.size()) fail("tile_designs has other columns");
  for (std::uint64_t t = 0; t < contents.tiles.size(); ++t) {
    const auto row = designs.row(t);
    for (std::size_t s = 0; s < statuses.size(); ++s) statuses[s] += row[s];
    contents.tiles_done += std::ranges::count(row, 0) < std::ssize(row);
  }
}

}  // namespace

hdf5::File open_archive(const std::filesystem::path& path) {
  hdf5::silence();
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open it"};
}

ArchiveHeader read_header(const std::filesystem::path& path) {
  return read_header(open_archive(path));
}

ArchiveContents read_contents(const std::filesystem::path& path) {
  const hdf5::File file = open_archive(path);
  const double format = hdf5::read_number_attribute(file, "format_version");
  if (format != format_version)
    throw std::runtime_error(
        fmt::format("format_version is {}, this program reads {}", format, format_version));
  ArchiveContents contents;
  contents.header = read_header(file);
  contents.scene = read_text(file, "scene");
  contents.kernel = read_text(file, "kernel");
  contents.summary = read_attributes(file);
  contents.extents = hdf5::extents(hdf5::open_dataset(file, "scene_lattice"));
  const std::vector<hsize_t> outer = contents.extents;
  const std::uint64_t scenes = hdf5::read_numbers<std::uint64_t>(file, "scene_lattice").size();
  if (!outer.empty()) contents.summary.optima = read_optima(file, outer, scenes);
  Index3 box{};
  constexpr std::array names{"r1", "r3", "r2"};
  for (std::size_t d = 0; d < 3; ++d) {
    contents.axes[d] = hdf5::read_numbers(file, names[d]);
    contents.extents.push_back(box[d] = contents.axes[d].size());
  }
  contents.tiles = read_tiles(file, scenes, box);
  read_designs(file, contents);
  contents.summary.complete = contents.tiles_done == contents.tiles.size();
  if (has(file, "tile_checksum"))
    contents.maps = read_table(file, "tile_checksum", contents.tiles.size()).columns;
  for (const std::string& map : contents.maps)
    if (hdf5::extents(hdf5::open_dataset(file, map)) != contents.extents)
      fail(fmt::format("the extent of map {} is not that of the axes", map));
  // So that damage to any of them is found.
  for (const std::string& name : hdf5::link_names(file))
    if (std::ranges::count(contents.maps, name) == 0) hdf5::read_numbers(file, name);
  return contents;
}

}  // namespace trebsweep
