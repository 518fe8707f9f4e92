#include "trebsweep/job/job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>

#include "trebsweep/base/error.hpp"
#include "trebsweep/job/config_file.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/job/rules.hpp"
#include "trebsweep/job/study.hpp"

namespace trebsweep {
namespace {

/// Values of keys, by the name of the key.
using Values = std::map<std::string, std::string>;

/// The name of a key without its section.
std::string key_of(const std::string& name) { return name.substr(name.find('.') + 1); }

[[noreturn]] void refuse_unknown(const std::string& name) {
  const std::string section = name.substr(0, name.find('.'));
  std::vector<std::string> known;
  for (const Key& key : job_keys())
    if (key.section() == section) known.push_back(key_of(key.name));
  if (section == "scene") known.push_back("file");
  if (!known.empty())
    throw InputError(fmt::format("{}: unknown key; the keys of [{}] are {}", shortened(name),
                                 section, fmt::join(known, ", ")));
  throw InputError(fmt::format("{}: {}; the sections are {}", shortened(name),
                               section == name ? "key before any [section]" : "unknown key",
                               fmt::join(job_sections, ", ")));
}

/// Throws InputError unless a key has the name.
void check_known(const std::string& name) {
  if (name != scene_file_key && std::ranges::count(job_keys(), name, &Key::name) == 0)
    refuse_unknown(name);
}

/// The values in the text of a job file, including scene.file.
Values parse_values(const std::string& text, const std::string& name) {
  const Values values = parse_config(text, name);
  for (const auto& [given, value] : values) check_known(given);
  return values;
}

/// The values without the keys to remove.
Values without(Values values, const std::vector<std::string>& unset) {
  const Values all = values;
  for (const std::string& key : unset) {
    check_known(key);
    if (values.erase(key) > 0) continue;
    std::vector<std::string> names;
    for (const auto& [name, value] : all) names.push_back(name);
    refuse("unset", key,
           names.empty() ? "left out: the job file sets no key"
                         : fmt::format("a key that the job file sets, given once: {}",
                                       fmt::join(names, ", ")));
  }
  return values;
}

/// The values in a scene file.
Values read_scene_file(const std::string& path) {
  const Values values = parse_values(read_job_file(path, scene_file_key + " = "), path);
  for (const auto& [name, value] : values) {
    if (name == scene_file_key)
      refuse(scene_file_key, path,
             fmt::format("a file that does not name another scene file (file = {})",
                         shortened(value)));
    if (!name.starts_with("scene."))
      refuse(scene_file_key, path,
             fmt::format("a file with keys of [scene] only, without {}", name));
  }
  return values;
}

/// Adds the values of `lower` whose keys are not in `higher`.
void add_missing(Values& higher, const Values& lower) {
  higher.insert(lower.begin(), lower.end());  // keeps existing values
}

/// The lattice of a job with a trough, whose scenes have one lattice: the values of their keys
/// ascend.
LatticeSpec with_trough_axes(const Job& job, bool has_increment) {
  double low = job.scene.fulcrum_height;
  double high = scene_at(job, count_scenes(job) - 1).fulcrum_height;
  for (const Variable& variable : job.optimum.variables)
    if (variable.key == "scene.fulcrum-height") {
      low = std::min(low, variable.lower);
      high = std::max(high, variable.upper);
    }
  return with_trough_axes(job.lattice, has_increment, low, high);
}

/// When a solver releases the projectile, to follow "release".
std::string release_text(const Solver& solver) {
  switch (solver.release) {
    case Release::crossing:
      return solver.release_angle == std::numbers::pi
                 ? "at phi1 = pi"
                 : fmt::format("at phi1 = {}", solver.release_angle);
    case Release::window:
      return fmt::format("at the first step with |pi - phi1| < {}", solver.release_window);
    case Release::pin:
      return fmt::format("by a pin at {} rad", solver.pin_angle.value());
    case Release::farthest:
      return "at the largest range";
    case Release::fastest:
      return "at the largest speed";
  }
  return "";
}

/// The value of a key; long lists are described.
std::string brief_value(const Key& key, const Job& job) {
  const std::string value = key.get(job);
  constexpr std::size_t longest = 100;
  const auto axis = std::ranges::find(job.outer_axes, key.name, &OuterAxis::key);
  if (value.size() <= longest || axis == job.outer_axes.end()) return value;
  return fmt::format("{} values from {} to {}", axis->values.size(), axis->values.front(),
                     axis->values.back());
}

}  // namespace

std::string job_name(const std::string& path) {
  return path == stdin_path ? "job" : std::filesystem::path(path).stem().string();
}

Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides,
              const std::string& ending, const std::vector<std::string>& unset) {
  const auto directory = std::filesystem::path(name).parent_path();
  const Values in_job = without(parse_values(text, name), unset);
  Job job;
  // From the highest precedence to the lowest: add_missing keeps what is given already.
  Values given = overrides;
  const auto add_scene_file = [&](const std::string& path) {
    add_missing(given, read_scene_file(path));
    job.scene_files.push_back(path);
  };
  if (overrides.count(scene_file_key)) add_scene_file(overrides.at(scene_file_key));
  add_missing(given, in_job);
  if (in_job.count(scene_file_key)) add_scene_file(directory / in_job.at(scene_file_key));
  given.emplace("output.file", job_name(name) + ending);

  for (const Key& key : job_keys())
    if (const auto value = given.find(key.name); value != given.end()) key.set(job, value->second);
  for (const Variable& variable : job.optimum.variables)
    if (!given.contains(variable.key))
      set_variables({&variable, 1}, std::array{(variable.lower + variable.upper) / 2}, job.scene,
                    job.solver);
  check_rules(job, given);
  if (job.scene.trough) job.lattice = with_trough_axes(job, given.contains("lattice.increment"));
  // Paths in the job file are relative to its directory, paths in options to the working directory.
  const auto resolve = [&](const char* key, std::vector<std::string>& paths) {
    if (overrides.count(key)) return;
    for (std::string& path : paths) path = directory / path;
  };
  resolve("assess.scenes", job.assess.scenes);
  resolve("assess.extremes", job.assess.extremes);
  return job;
}

std::string to_text(const Job& job, bool with_assessment) {
  const auto unused = unused_keys(job);
  std::string text, section;
  for (const Key& key : job_keys()) {
    const std::string value = key.get(job);
    if (value.empty() || (key.section() == "assess" && !with_assessment)) continue;
    if (unused.count(key.name) > 0) continue;
    if (section != key.section()) {
      section = key.section();
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}\n", key_of(key.name), value);
  }
  return text;
}

std::string scene_text(const Job& job) {
  const Job defaults;
  std::vector<std::string> differing;
  for (const Key& key : job_keys())
    if (key.section() == "scene" && key.get(job) != key.get(defaults))
      differing.push_back(fmt::format("{} = {}", key_of(key.name), brief_value(key, job)));
  const std::string files = fmt::format("{}", fmt::join(job.scene_files, ", "));
  return printable(fmt::format("{}{}{}", files, files.empty() ? "" : ": ",
                               differing.empty() ? "the paper's (all keys at their defaults)"
                                                 : fmt::format("{}", fmt::join(differing, ", "))));
}

std::string trough_axes_text(const Job& job) {
  if (!job.scene.trough) return "";
  Job defaults = job;
  defaults.lattice.r3 = defaults.lattice.r2 = std::nullopt;
  defaults.lattice = with_trough_axes(defaults, true);
  std::vector<std::string> axes;
  for (const Key& key : job_keys())
    if ((key.name == "lattice.r3" || key.name == "lattice.r2") && key.get(job) == key.get(defaults))
      axes.push_back(fmt::format("{} = {}", key_of(key.name), key.get(job)));
  return axes.empty() ? "" : fmt::format("{} m (default with a trough)", fmt::join(axes, ", "));
}

std::string solver_text(const Solver& solver) {
  const std::string setting = follows_tolerance(solver.stepper)
                                  ? fmt::format("tolerance {:.3g}", solver.tolerance)
                                  : fmt::format("time step {} s", solver.time_step);
  return fmt::format("{}, {}, release {}", solver.stepper, setting, release_text(solver));
}

}  // namespace trebsweep
