#include "trebsweep/archive/archive_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

/// The tallies of the tiles that are done.
std::vector<TallyRow> read_tallies(hid_t file, const std::vector<double>& done) {
  const auto values = hdf5::read_numbers(file, "tile_tally");
  constexpr std::size_t columns = tally_columns.size();
  if (values.size() != done.size() * columns)
    untrusted::fail("tile_tally does not have one row per tile");
  std::vector<TallyRow> rows;
  for (std::size_t t = 0; t < done.size(); ++t)
    if (done[t] == 1) std::copy_n(&values[t * columns], columns, rows.emplace_back().begin());
  return rows;
}

/// The measured error of a complete sweep, or none if it was not measured.
std::optional<MeasuredError> read_error(hid_t file) {
  const auto read = [&](const char* name) { return hdf5::read_number_attribute(file, name); };
  if (!(read("error_designs") > 0)) return std::nullopt;
  return MeasuredError{.median = read("error_median"),
                       .largest = read("error_largest"),
                       .at_optimum = read("error_at_optimum"),
                       .designs = static_cast<std::uint64_t>(read("error_designs"))};
}

/// The optimum between the designs of a complete sweep of one scene, or none if it was not searched
/// for.
std::optional<RefinedOptimum> read_refined(hid_t file) {
  const auto read = [&](const char* name) { return hdf5::read_number_attribute(file, name); };
  if (std::isnan(read("refined_error"))) return std::nullopt;
  return RefinedOptimum{{{read("best_r1"), read("best_r3"), read("best_r2")},
                         read("best_value"),
                         read("best_speed"),
                         read("best_release_time")},
                        read("refined_error")};
}

std::vector<hsize_t> outer_extents(const Job& job) {
  std::vector<hsize_t> extents;
  for (const OuterAxis& axis : job.outer_axes) extents.push_back(axis.values.size());
  return extents;
}

/// Throws if a map that the archive's job asks for is missing or has another extent.
void check_maps(hid_t file, const ArchiveContents& contents, const Job& job) {
  std::vector<hsize_t> extents = outer_extents(job);
  for (const auto& axis : contents.axes) extents.push_back(axis.size());
  for (const Field field : stored_fields(job.output))
    if (hdf5::extents(hdf5::open_dataset(file, dataset_name(field))) != extents)
      untrusted::fail(
          fmt::format("the extent of map {} is not that of the axes", dataset_name(field)));
}

}  // namespace

ArchiveContents read_contents(const std::filesystem::path& path) {
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
  const Job job = parse_job(contents.job, "archive", {});
  for (const OuterAxis& axis : job.outer_axes)
    contents.outer_axes.push_back(hdf5::read_numbers(file, dataset_name(axis.name())));
  contents.axes = {hdf5::read_numbers(file, "r1"), hdf5::read_numbers(file, "r3"),
                   hdf5::read_numbers(file, "r2")};
  const hdf5::Dataset tile_done = hdf5::open_dataset(file, "tile_done");
  constexpr std::array edges{"edge_r1", "edge_r3", "edge_r2"};
  for (std::size_t d = 0; d < 3; ++d)
    contents.tile_edge[d] = read_edge(tile_done, edges[d], contents.axes[d].size());
  const auto done = hdf5::read_numbers(file, "tile_done");
  contents.tiles = done.size();
  contents.tallies = read_tallies(file, done);
  contents.tiles_done = contents.tallies.size();
  if (is_study(job))
    contents.optima = read_optima(file, outer_extents(job));
  else
    contents.refined = read_refined(file);
  contents.error = read_error(file);
  check_maps(file, contents, job);
  return contents;
}

Tally ArchiveContents::tally() const {
  const std::uint64_t scenes = outer_axes.empty() ? 1 : optima.size();
  const std::uint64_t cells = scenes * axes[0].size() * axes[1].size() * axes[2].size();
  Tally sum;
  for (const TallyRow& row : tallies) {
    const Tally tally = to_tally(row);
    if (tally.designs() == 0) untrusted::fail("a tile is marked done but has no designs");
    if (tally.best.exists() && tally.best.cell >= cells)
      untrusted::fail("the best design of a tile lies outside the lattice");
    for (const std::uint64_t first : tally.first_cells)
      if (first != no_cell && first >= cells)
        untrusted::fail("a design of a tile lies outside the lattice");
    sum.add(tally);
  }
  return sum;
}

Tiling ArchiveContents::tiling(const Study& study) const {
  const auto is_same = [](const std::vector<double>& values, const OuterAxis& axis) {
    return values == axis.values;
  };
  if (!std::ranges::equal(outer_axes, study.job().outer_axes, is_same))
    untrusted::fail("its outer axes are not those of its job");
  if (axes != study.axes()) untrusted::fail("its lattice is not that of its job");
  const Tiling tiling(study, tile_edge);
  if (tiles != tiling.size()) untrusted::fail("its tiles are not those of its lattice");
  return tiling;
}

}  // namespace trebsweep
