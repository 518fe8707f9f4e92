#include "trebsweep/archive/scene_optimum.hpp"

#include <bit>
#include <string>

#include "trebsweep/archive/hdf5.hpp"
#include "trebsweep/archive/untrusted_file.hpp"

namespace trebsweep {
namespace {

using Members = std::array<double, scene_optimum_names.size()>;

}  // namespace

std::optional<std::uint64_t> best_scene(std::span<const SceneOptimum> optima) {
  std::optional<std::uint64_t> best;
  for (std::uint64_t scene = 0; scene < optima.size(); ++scene)
    if (optima[scene].exists() && (!best || optima[scene].value > optima[*best].value))
      best = scene;
  return best;
}

std::vector<SceneOptimum> read_optima(hid_t file, const std::vector<hsize_t>& extents) {
  std::vector<Members> members;
  for (std::size_t d = 0; d < scene_optimum_names.size(); ++d) {
    const std::string name(scene_optimum_names[d]);
    if (hdf5::extents(hdf5::open_dataset(file, name)) != extents)
      untrusted::fail("the extent of " + name + " is not that of the outer axes");
    const auto values = hdf5::read_numbers(file, name);
    members.resize(values.size());
    for (std::size_t s = 0; s < values.size(); ++s) members[s][d] = values[s];
  }
  std::vector<SceneOptimum> optima;
  for (const Members& scene : members) optima.push_back(std::bit_cast<SceneOptimum>(scene));
  return optima;
}

}  // namespace trebsweep
