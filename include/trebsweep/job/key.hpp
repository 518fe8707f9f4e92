#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// The sections of a job file, in their order.
inline constexpr std::array<std::string_view, 6> job_sections{"scene",  "lattice", "solver",
                                                              "output", "optimum", "assess"};

/// One key of the job file, which is also a command-line option.
struct Key {
  std::string name;         ///< "section.key"
  std::string placeholder;  ///< of its value, in help: "NUMBER"
  std::string meaning;      ///< in words
  std::string unit;         ///< of a number: "kg"; empty if it has none
  std::string allowed;      ///< the values allowed
  /// Throws InputError naming the key, the value and what is allowed.
  std::function<void(Job&, const std::string&)> set;
  /// The value as text that `set` accepts; empty if an optional key is not set.
  std::function<std::string(const Job&)> get;
  /// Sets the number of a scene; empty for a key that cannot be an outer axis.
  std::function<void(Scene&, double)> set_number = {};
  /// The number of a scene, NaN if it is not set; empty where set_number is.
  std::function<double(const Scene&)> number = {};

  /// Its meaning, its unit and what is allowed.
  std::string help() const;

  std::string section() const { return name.substr(0, name.find('.')); }
};

/// Every key, in the order of the job file.
const std::vector<Key>& job_keys();

/// Whether a scene whose value of a key is zero lacks an effect that it has with any other value.
bool is_absent_at_zero(std::string_view name);

/// The key that names a scene file. A relative path starts at the job file's directory or, if given
/// as an option, at the working directory. It is not a Key because a Job holds the scene itself.
inline const std::string scene_file_key = "scene.file";

}  // namespace trebsweep
