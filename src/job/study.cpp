#include "trebsweep/job/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <tuple>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/model/start.hpp"

namespace trebsweep {
namespace {

/// What the lattice of a scene depends on.
auto lattice_key(const Scene& scene) {
  return std::tuple(scene.fulcrum_height, scene.release_height, scene.counterweight_hanger,
                    starts_at_release_height(scene), scene.trough);
}

/// The values along an axis of all lattices, each once, in ascending order.
std::vector<double> united(const std::vector<Lattice>& lattices, std::size_t axis) {
  if (lattices.size() == 1) return lattices.front().axes()[axis];
  std::vector<double> values;
  for (const Lattice& lattice : lattices) {
    const std::vector<double>& own = lattice.axes()[axis];
    values.insert(values.end(), own.begin(), own.end());
  }
  std::ranges::sort(values);
  const auto repeated = std::unique(values.begin(), values.end());
  values.erase(repeated, values.end());
  return values;
}

/// The box of all lattices. Throws InputError if it has too many cells for a number of scenes.
LatticeAxes common_box(const std::vector<Lattice>& lattices, std::uint64_t scenes) {
  const LatticeAxes box{united(lattices, 0), united(lattices, 1), united(lattices, 2)};
  constexpr double max_cells = 1e15;  // a double counts them exactly
  double cells = static_cast<double>(scenes);
  for (const auto& axis : box) cells *= static_cast<double>(axis.size());
  if (cells > max_cells)
    throw InputError(fmt::format(
        "lattice.increment: {} scenes with lattices within {} x {} x {} (r1 x r3 x r2) have {:.3g} "
        "cells; at most {:g} are allowed",
        scenes, box[0].size(), box[1].size(), box[2].size(), cells, max_cells));
  return box;
}

}  // namespace

const Key& key_of(const OuterAxis& axis) {
  return *std::ranges::find(job_keys(), axis.key, &Key::name);
}

std::uint64_t count_scenes(const Job& job) {
  std::uint64_t count = 1;
  for (const OuterAxis& axis : job.outer_axes) count *= axis.values.size();
  return count;
}

void check_scene_count(const Job& job) {
  constexpr double max_scenes = 1e6;
  double scenes = 1;
  for (const OuterAxis& axis : job.outer_axes) scenes *= static_cast<double>(axis.values.size());
  if (scenes <= max_scenes) return;
  const OuterAxis& last = job.outer_axes.back();
  refuse(last.key, last.text,
         fmt::format("fewer values: with those of the keys before it they make {:.0f} scenes; at "
                     "most {:.0f} are allowed",
                     scenes, max_scenes));
}

std::vector<std::uint64_t> outer_index(const Job& job, std::uint64_t scene) {
  std::vector<std::uint64_t> index(job.outer_axes.size());
  for (std::size_t a = index.size(); a-- > 0;) {
    index[a] = scene % job.outer_axes[a].values.size();
    scene /= job.outer_axes[a].values.size();
  }
  return index;
}

Scene scene_at(const Job& job, std::uint64_t scene) {
  Scene result = job.scene;
  const auto index = outer_index(job, scene);
  for (std::size_t a = 0; a < index.size(); ++a)
    key_of(job.outer_axes[a]).set_number(result, job.outer_axes[a].values[index[a]]);
  return result;
}

Job job_at(const Job& job, std::uint64_t scene) {
  // Without copying the outer axes, which may have as many values as there are scenes.
  return {.scene = scene_at(job, scene),
          .outer_axes = {},
          .scene_files = job.scene_files,
          .lattice = job.lattice,
          .solver = job.solver,
          .output = job.output,
          .optimum = job.optimum,
          .assess = job.assess};
}

std::string outer_values_text(const Job& job, std::uint64_t scene) {
  const auto index = outer_index(job, scene);
  std::vector<std::string> values;
  for (std::size_t a = 0; a < index.size(); ++a) {
    const OuterAxis& axis = job.outer_axes[a];
    const std::string& unit = key_of(axis).unit;
    values.push_back(fmt::format("{} = {}{}{}", axis.name(), axis.values[index[a]],
                                 unit.empty() ? "" : " ", unit));
  }
  return fmt::format("{}", fmt::join(values, ", "));
}

void require_one_scene(const Job& job, const std::string& reason) {
  if (!is_study(job)) return;
  const OuterAxis& axis = job.outer_axes.front();
  refuse(axis.key, axis.text, "a single number: " + reason);
}

Study::Study(const Job& job) : job_(job) {
  const std::uint64_t scenes = count_scenes(job);
  std::map<decltype(lattice_key(job.scene)), std::uint32_t> found;
  for (std::uint64_t scene = 0; scene < scenes; ++scene) {
    const auto number = static_cast<std::uint32_t>(own_.size());
    const auto [place, is_new] = found.try_emplace(lattice_key(scene_at(job, scene)), number);
    if (is_new)
      name_scene_in_errors(job, scene,
                           [&] { own_.emplace_back(scene_at(job, scene), job.lattice); });
    lattice_of_.push_back(place->second);
  }
  const auto box = std::make_shared<const LatticeAxes>(common_box(own_, scenes));
  lattices_ = own_;
  for (Lattice& lattice : lattices_) lattice.extend_to(box);
}

std::uint64_t Study::designs() const {
  std::uint64_t sum = 0;
  for (const std::uint32_t lattice : lattice_of_) sum += lattices_[lattice].designs();
  return sum;
}

std::uint64_t Study::cell(std::uint64_t scene, const Index3& index) const {
  const auto& [n1, n3, n2] = extent();
  return ((scene * n1 + index[0]) * n3 + index[1]) * n2 + index[2];
}

std::uint64_t Study::cells() const {
  const auto& [n1, n3, n2] = extent();
  return scenes() * n1 * n3 * n2;
}

std::pair<std::uint64_t, Design<double>> Study::design(std::uint64_t cell) const {
  const auto& [n1, n3, n2] = extent();
  const Index3 index{cell / n2 / n3 % n1, cell / n2 % n3, cell % n2};
  return {cell / n2 / n3 / n1, lattices_.front().design(index)};
}

}  // namespace trebsweep
