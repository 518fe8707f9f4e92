// Prints a hash of the results of every stepper for packs with every effect, to compare kernels bit
// by bit. The instruction set goes to stderr.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/swing/kernel.hpp"

using namespace trebsweep;

namespace {

struct NamedScene {
  std::string name;
  Scene scene;
  Release release = Release::crossing;
};

/// Scenes that have every effect, and one that changes only constants.
std::vector<NamedScene> scenes() {
  Scene heavy_sling, pivot, elastic;
  heavy_sling.sling_mass = 20;
  heavy_sling.sling_angle = 0.3;
  heavy_sling.projectile_diameter = 0.3;
  pivot.pivot_viscosity = 200;
  pivot.pivot_friction = 300;
  elastic.sling_stiffness = 1e5;
  elastic.sling_angle = -0.2;
  Scene all = pivot;
  all.sling_mass = 5;
  all.sling_stiffness = 2e4;
  all.sling_damping = 100;
  Scene built = pivot;  // some slings do not reach the trough
  built.start_angle = 0.8;
  built.counterweight_hanger = 0.3;
  built.trough = true;
  built.trough_height = 0.8;
  return {{"rigid", {}},
          {"heavy sling and drag", heavy_sling},
          {"pivot", pivot},
          {"elastic", elastic},
          {"all effects of an elastic sling", all},
          {"hanger, trough and pivot", built, Release::farthest}};
}

/// Designs spread evenly over a box, by multiples of irrational numbers.
std::vector<Design<double>> designs(int count) {
  const auto between = [](double first, double last, double turns) {
    return first + (last - first) * (turns - std::floor(turns));
  };
  std::vector<Design<double>> all;
  for (int i = 1; i <= count; ++i)
    all.push_back({between(0.51, 1.2, i * 0.8191725134), between(0.2, 0.6, i * 0.6710436067),
                   between(0.3, 0.9, i * 0.5497004779)});
  return all;
}

/// The fields that the kernel computes, in addition to SwingResult.
std::vector<Field> kernel_fields() {
  std::vector<Field> fields;
  for (const FieldInfo& info : field_info)
    if (is_of_swing(info.field)) fields.push_back(info.field);
  return fields;
}

/// A hash (FNV-1a, a word at a time) of the results and of the values of some fields.
std::uint64_t hash_of(std::span<const SwingResult> results, std::span<const double> values) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](auto number) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(number)) * 0x100000001b3;
  };
  for (const SwingResult& result : results) {
    add(result.speed);
    add(result.release_time);
    add(result.steps);
    add(static_cast<std::uint64_t>(result.status));
  }
  for (const double value : values) add(value);
  return hash;
}

/// Integrates designs and prints a line: what, how many have a speed, hash.
void print_hash(const std::string& what, const Scene& scene, const Solver& solver,
                const std::vector<Design<double>>& designs, const std::vector<Field>& fields) {
  std::vector<SwingResult> results(designs.size());
  std::vector<double> values(designs.size() * fields.size());
  integrate_packs(scene, solver, {designs, results, fields, values});
  const auto released =
      std::count_if(results.begin(), results.end(),
                    [](const SwingResult& result) { return has_speed(result.status); });
  std::printf("%s: %td of %zu released, %016llx\n", what.c_str(), released, results.size(),
              static_cast<unsigned long long>(hash_of(results, values)));
}

}  // namespace

int main() {
  std::fprintf(stderr, "%s\n", std::string(instruction_set()).c_str());
  for (const std::string_view stepper : stepper_names) {
    if (!is_for_packs(stepper)) continue;
    Solver solver{.stepper = std::string(stepper)};
    solver.time_step = 0.02;
    solver.max_time = 0.75;  // some designs are released, some are not
    for (const auto& [name, scene, release] : scenes()) {
      solver.release = release;
      const std::string what = solver.stepper + ", " + name;
      print_hash(what, scene, solver, designs(1000), {});
      print_hash(what + ", all fields", scene, solver, designs(40), kernel_fields());
    }
  }
}
