#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/job/lattice.hpp"
#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// The number type of the maps in the archive.
enum class Storage { float64, float32 };

/// In the order of Storage.
inline constexpr std::array<std::string_view, 2> storage_names{"float64", "float32"};

/// Which shots compete for the optimum: all, or those whose sling never goes slack.
enum class OptimumFilter { all, taut };

/// In the order of OptimumFilter.
inline constexpr std::array<std::string_view, 2> optimum_filter_names{"all", "taut"};

/// What a job stores, and where.
struct Output {
  std::string file;  ///< the archive's path
  std::vector<Field> fields = {Field::speed, Field::release_time, Field::status};
  Storage storage = Storage::float64;
  OptimumFilter optimum_filter = OptimumFilter::all;
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
  /// Options of the command line for the scenes, lattices and solvers of all the files.
  std::map<std::string, std::string> overrides;
};

/// All that a sweep needs to know.
struct Job {
  Scene scene;
  std::vector<std::string> scene_files;  ///< paths of the files that set keys of it, as given
  LatticeSpec lattice;
  Solver solver;
  Output output;
  Assessment assess;
};

/// Values given on the command line, by key name; scene_file among them.
using Overrides = std::map<std::string, std::string>;

/// The job of a job file's text; `name` is the file's name, for messages, for the archive's
/// default name (its stem + ".h5"), and for the folder of the files that the job names.
///
/// A key of [scene] may be given in four places. The first of these that gives it wins:
/// `overrides`, the file that their scene.file names, the job's [scene], the file that this names.
/// Throws InputError, also where a key is given that the solver does not use.
Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides);

/// The job as the text of a job file: every key that its solver uses, with its value. Keys of
/// [assess] change no map and are included on demand.
std::string to_text(const Job& job, bool with_assessment = false);

/// The scene in one line: its files, and every key that differs from the default.
std::string scene_text(const Job& job);

/// The solver in one line: the stepper, its setting and the release rule.
std::string solver_text(const Solver& solver);

}  // namespace trebsweep
