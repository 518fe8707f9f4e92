#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trebsweep/job/job.hpp"

namespace trebsweep {

/// One key of the job file, which is also a command-line option.
struct Key {
  std::string name;  ///< "section.key"
  std::string help;  ///< what it is, its unit, what is allowed
  /// Throws InputError naming key, value and what is allowed.
  std::function<void(Job&, const std::string&)> set;
  std::function<std::string(const Job&)> get;

  std::string section() const { return name.substr(0, name.find('.')); }
};

/// Every key, in the order of the job file.
const std::vector<Key>& job_keys();

/// The key that names a file with a scene: relative to the job file, or, as an option, to the
/// current folder. It is not a Key, since a Job holds the scene itself.
inline const std::string scene_file = "scene.file";

}  // namespace trebsweep
