#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trebsweep/field.hpp"
#include "trebsweep/lattice.hpp"
#include "trebsweep/scene.hpp"
#include "trebsweep/solver.hpp"
#include "trebsweep/stepper_names.hpp"

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

/// What `trebsweep assess` is to look at.
struct Assessment {
  std::vector<std::string> scenes;    ///< scene or job files; none: the job's own scene
  std::vector<std::string> extremes;  ///< the same, to be tried with one setting per stepper
  std::vector<std::string> steppers = {stepper_names.begin(), stepper_names.end()};
  std::vector<double> time_steps = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4};    ///< s, of fixed steppers
  std::vector<double> tolerances = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};  ///< of adaptive ones
  std::uint64_t designs = 24;   ///< of a scene's lattice, beside its corners and optimum
  std::uint64_t repeats = 5;    ///< of a run that is timed
  double target_error = 1e-6;   ///< m/s, that advice is given for
  double lattice_seconds = 10;  ///< longest run over a whole lattice; 0: none
};

/// All that a sweep needs to know.
struct Job {
  Scene scene;
  LatticeSpec lattice;
  Solver solver;
  Output output;
  Assessment assess;
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
/// file's [scene] stands for what the job's own leaves out. Files of [assess] have their place by
/// the same rule. Throws InputError.
Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides);

/// The text of a job file. Throws InputError if it is missing, unreadable or no text.
std::string read_job_file(const std::string& path);

/// The job as the text of a job file, every key with its value; those of [assess], which change no
/// map, on demand.
std::string to_text(const Job& job, bool with_assessment = false);

}  // namespace trebsweep
