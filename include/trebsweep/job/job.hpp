#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "trebsweep/job/constraint.hpp"
#include "trebsweep/job/lattice.hpp"
#include "trebsweep/job/outer_axis.hpp"
#include "trebsweep/job/variable.hpp"
#include "trebsweep/model/scene.hpp"
#include "trebsweep/ode/solver.hpp"
#include "trebsweep/ode/stepper_info.hpp"
#include "trebsweep/swing/field.hpp"

namespace trebsweep {

/// The number type of the maps in the archive.
enum class Storage { float64, float32 };

/// In the order of Storage.
inline constexpr std::array<std::string_view, 2> storage_names{"float64", "float32"};

/// Which designs compete for the optimum: all, or those whose sling never goes slack.
enum class OptimumFilter { all, taut };

/// In the order of OptimumFilter.
inline constexpr std::array<std::string_view, 2> optimum_filter_names{"all", "taut"};

/// Whether maps are stored, or only the optimum of each scene.
enum class Maps { all, none };

/// In the order of Maps.
inline constexpr std::array<std::string_view, 2> maps_names{"all", "none"};

/// What a sweep stores, and where.
struct Output {
  std::string file;  ///< the archive's path
  std::vector<Field> fields = {Field::speed, Field::release_time, Field::status};
  Storage storage = Storage::float64;
  OptimumFilter optimum_filter = OptimumFilter::all;
  int compression = 0;  ///< deflate level, 0 (off) to 9
  Maps maps = Maps::all;
};

/// The fields whose maps are stored.
inline std::vector<Field> stored_fields(const Output& output) {
  return output.maps == Maps::all ? output.fields : std::vector<Field>{};
}

/// What a search for the optimum makes as large as possible: the objective of the design itself, or
/// that of designs whose lengths are off by up to a deviation, at worst or on average.
enum class Robust { no, worst, expected };

/// In the order of Robust.
inline constexpr std::array<std::string_view, 3> robust_names{"no", "worst", "expected"};

/// Which design is the optimum: that with the largest objective among those that satisfy all
/// constraints.
struct OptimumSpec {
  Expression objective = to_expression(Field::speed);  ///< of at least one field
  std::vector<Constraint> constraints;                 ///< `subject-to`
  std::vector<Variable> variables;                     ///< searched besides the lengths
  double deviation = 0;  ///< m: by how much each built length may be off
  Robust robust = Robust::no;
  bool refine = false;    ///< whether a sweep searches between the designs of its lattice
  bool buildable = true;  ///< whether the search is among designs that can be built
};

/// What `trebsweep assess` compares.
struct Assessment {
  std::vector<std::string> scenes;    ///< scene or job files; if empty, the job's own scene
  std::vector<std::string> extremes;  ///< scene or job files to try with one setting per stepper
  std::vector<std::string> steppers = {stepper_names.begin(), stepper_names.end()};
  std::vector<double> time_steps = {1e-2, 3e-3, 1e-3, 3e-4, 1e-4};    ///< s, of fixed-step steppers
  std::vector<double> tolerances = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};  ///< of adaptive steppers
  std::uint64_t designs = 24;   ///< sampled per lattice, in addition to its corners and optimum
  std::uint64_t repeats = 5;    ///< runs per time measurement
  double target_error = 1e-6;   ///< m/s: the cheapest solver that meets it is recommended
  double lattice_seconds = 10;  ///< s: longest run over a whole lattice; 0: no such run
  /// Command-line options that apply to the scenes, lattices and solvers of all files.
  std::map<std::string, std::string> overrides;
};

/// A job file with its command-line options: everything a command needs to know.
struct Job {
  Scene scene;                        ///< of a study: the scene with the first value of each axis
  std::vector<OuterAxis> outer_axes;  ///< of a study: keys of [scene] with several values
  std::vector<std::string> scene_files;  ///< paths, as given, of the files that set scene keys
  LatticeSpec lattice;
  Solver solver;
  Output output;
  OptimumSpec optimum;
  Assessment assess;
};

/// Values given on the command line, by key name, including scene.file.
using Overrides = std::map<std::string, std::string>;

/// How the default name of an archive of an assessment ends; that of a sweep ends in ".h5".
inline constexpr const char* assessment_ending = "-assess.h5";

/// The path of a job file that means stdin.
inline constexpr const char* stdin_path = "-";

/// The name of a job: that of its file, without directory and extension, or "job" for stdin.
std::string job_name(const std::string& path);

/// Parses the text of a job file. `name` is the file's path: it appears in messages, its job_name()
/// + `ending` is the archive's default name, and its directory resolves relative paths in the job.
///
/// The value of a scene key is taken from the first of these that sets it: `overrides`, the file
/// named by their scene.file, the job's own [scene], the file named by the job's scene.file.
/// The keys in `unset` are removed from the job file first. Throws InputError, also if a key is
/// given that the scene or the solver does not use, or one is to be removed that the file does not
/// set.
Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides,
              const std::string& ending = ".h5", const std::vector<std::string>& unset = {});

/// The canonical text of a job: a job file with the value of every key that the job uses. The keys
/// of [assess] do not affect maps and are included on request.
std::string to_text(const Job& job, bool with_assessment = false);

/// The scene on one line: its files, and every key that differs from its default.
std::string scene_text(const Job& job);

/// The axes r3 and r2 that a job with a trough has by default: "r3 = 0.6:3.3:0.05 m (default with a
/// trough)"; empty if they differ from the default.
std::string trough_axes_text(const Job& job);

/// The solver on one line: the stepper, its step or tolerance, and the release condition.
std::string solver_text(const Solver& solver);

}  // namespace trebsweep
