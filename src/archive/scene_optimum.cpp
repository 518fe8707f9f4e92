#include "trebsweep/archive/scene_optimum.hpp"

#include <bit>
#include <string>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/map_shape.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

namespace trebsweep {
namespace {

using hdf5::check;
using Members = std::array<double, scene_optimum_names.size()>;

/// Selects consecutive scenes in a dataset over the outer axes, of which they are not a block.
/// Returns the dataspace of a list of them.
hdf5::Dataspace select_scenes(hid_t space, const std::vector<hsize_t>& extents,
                              std::uint64_t first_scene, hsize_t count) {
  const std::string what = "select scenes";
  std::vector<hsize_t> cells;
  for (std::uint64_t scene = first_scene; scene < first_scene + count; ++scene) {
    const auto cell = unflattened(scene, extents);
    cells.insert(cells.end(), cell.begin(), cell.end());
  }
  check(H5Sselect_elements(space, H5S_SELECT_SET, count, cells.data()), what);
  return {H5Screate_simple(1, &count, nullptr), what};
}

}  // namespace

std::optional<std::uint64_t> best_scene(std::span<const SceneOptimum> optima) {
  std::optional<std::uint64_t> best;
  for (std::uint64_t scene = 0; scene < optima.size(); ++scene)
    if (optima[scene].exists() && (!best || optima[scene].value > optima[*best].value))
      best = scene;
  return best;
}

void write_optima(hid_t file, std::uint64_t first_scene, std::span<const SceneOptimum> optima) {
  if (optima.empty()) return;
  for (std::size_t d = 0; d < scene_optimum_names.size(); ++d) {
    const std::string name(scene_optimum_names[d]), what = "write " + name;
    const hdf5::Dataset dataset = hdf5::open_dataset(file, name);
    const hdf5::Dataspace space(H5Dget_space(dataset), what);
    const auto memory = select_scenes(space, hdf5::extents(dataset), first_scene, optima.size());
    std::vector<double> values;
    for (const SceneOptimum& optimum : optima) values.push_back(std::bit_cast<Members>(optimum)[d]);
    check(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
  }
}

std::vector<SceneOptimum> read_optima(hid_t file, const std::vector<hsize_t>& extents,
                                      std::uint64_t first_scene, std::uint64_t count) {
  std::vector<Members> members(count);
  for (std::size_t d = 0; d < scene_optimum_names.size(); ++d) {
    const std::string name(scene_optimum_names[d]), what = "read " + name;
    const hdf5::Dataset dataset = hdf5::open_dataset(file, name);
    if (hdf5::extents(dataset) != extents)
      untrusted::fail("the extent of " + name + " is not that of the outer axes");
    const hdf5::Dataspace space(H5Dget_space(dataset), what);
    const auto memory = select_scenes(space, extents, first_scene, count);
    std::vector<double> values(count);
    check(H5Dread(dataset, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values.data()), what);
    for (std::size_t s = 0; s < count; ++s) members[s][d] = values[s];
  }
  std::vector<SceneOptimum> optima;
  for (const Members& scene : members) optima.push_back(std::bit_cast<SceneOptimum>(scene));
  return optima;
}

}  // namespace trebsweep
