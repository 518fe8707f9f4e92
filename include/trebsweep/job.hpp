#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trebsweep/field.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/scene.hpp"
#include "trebsweep/solver.hpp"

namespace trebsweep {

/// The number type of the maps in the archive.
enum class Storage { float64, float32 };

/// Which shots compete for the optimum: all, or those whose sling never goes slack.
enum class Contest { all, taut };

/// What a job stores, and where.
struct Output {
  std::string file;  ///< the archive's path
  std::vector<Field> fields = {Field::speed, Field::release_time, Field::status};
  Storage storage = Storage::float64;
  Contest contest = Contest::all;
  int compression = 0;  ///< deflate level, 0 (off) to 9
};

/// All that a sweep needs to know.
struct Job {
  Scene scene;
  LatticeSpec lattice;
  Solver solver;
  Output output;
};

/// One key of the job file, which is also a command-line option.
struct Key {
  std::string name;  ///< "section.key"
  std::string help;  ///< what it is, its unit, what is allowed
  std::function<void(Job&, const std::string&)>
      set;  ///< throws InputError naming key, value, allowed
  std::function<std::string(const Job&)> get;
};

/// The key that names a file with a scene: relative to the job file, or, as an option, to the
/// current folder. It is no Key, as a Job has the scene itself.
inline const std::string scene_file = "scene.file";

/// Every key, in the order of the job file.
const std::vector<Key>& job_keys();

/// Values given on the command line, by key name.
using Overrides = std::map<std::string, std::string>;

/// The job of a job file's text; `name` is the file's name, for messages, for the archive's
/// default name (its stem + ".h5"), and for the place of the scene file that the job may name: that
/// file's [scene] stands for what the job's own leaves out. Throws InputError.
Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides);

/// The text of a job file. Throws InputError if it is missing, unreadable or no text.
std::string read_job_file(const std::string& path);

/// The job as the text of a job file, every key with its value.
std::string to_text(const Job& job);

}  // namespace trebsweep
