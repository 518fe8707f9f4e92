#include "trebsweep/cli/command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/program_options.hpp>
#include <sstream>

#include "trebsweep/base/error.hpp"
#include "trebsweep/base/number.hpp"
#include "trebsweep/job/key.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

constexpr std::array progress_names{"auto", "bar", "lines", "none"};

const char* const general_help =
    R"(trebsweep: explores the design space of a trebuchet.

Usage:
  trebsweep sweep JOB [options]      integrate every design of the job's lattice -> HDF5 archive
                                     (in parallel: mpirun -n RANKS trebsweep sweep JOB)
  trebsweep trace JOB --r1 M --r2 M --r3 M [options]
                                     print one design's swing as a table
  trebsweep assess JOB [options]     measure errors, run times and stability of steppers -> tables
                                     (in parallel, like sweep)
  trebsweep info FILE                what an archive, or an unfinished one, holds
  trebsweep COMMAND --help           the options of a command, with every key of a job file
  trebsweep --version

JOB is a text file of keys with their values; jobs/paper.cfg is one to start from. Every key is also an
option, which overrides the file: --solver.tolerance 1e-9. A scene key is taken from the first of these
that gives it: the option --scene.KEY, the file named by the option --scene.file, the job's [scene], the
file that the job's [scene] names, the default.

Exit codes: 0 complete, 1 run-time error, 2 bad command line or job file, 75 stopped before the end
(the same command continues).
)";

const char* const sweep_help =
    R"(Usage: trebsweep sweep JOB [options]

Integrates every design (r1, r3, r2) of the job's lattice, on all ranks it was started with, and writes
maps of what each one does into one HDF5 archive (see output.file). While it works, the file's name ends
in .partial.

The same command continues an interrupted sweep, on any number of ranks; even a kill loses only the last
few seconds. SIGINT (Ctrl-C), SIGTERM, SIGUSR1 and --time-limit stop a sweep with everything written and
exit code 75. Warnings after the summary name what makes the result doubtful.

)";

const char* const trace_help =
    R"(Usage: trebsweep trace JOB --r1 M --r2 M --r3 M [options]

Prints the swing of one design, from rest to its release, as a table. Comment lines (#) with the heights
and the release rule come first, then the header, then a row for each time, with the columns
  t        time, s
  phi1     angle of the counterweight's arm from the upward vertical, clockwise, rad
  phi2     angle of the sling from the downward vertical, clockwise, rad
  w1 w2    their rates, rad/s
  x1 y1    counterweight, m from the fulcrum
  xt yt    tip of the throwing arm
  x3 y3    projectile
  speed    of the projectile, m/s
  energy   kinetic and potential, and of the sling's stretch, J
  tension  pull of the sling on the projectile, N; below zero where a rigid one would have to push
  tip_tension
           its pull on the arm's tip: more than that if it has a mass
  axle     force on the axle, N
  stress   bending stress of the beam at the fulcrum, Pa

)";

const char* const assess_help =
    R"(Usage: trebsweep assess JOB [options]

Holds steppers and their settings against references in quadruple precision, on a sample of the designs
of each scene that [assess] names (or of the job's own): errors, steps, run time, order of convergence,
the largest stable step, errors on the whole lattice; and names the cheapest solver for a wanted error.
The tables are printed, and written into output.file, where xarray reads each as a group.

)";

const char* const info_help =
    R"(Usage: trebsweep info FILE

Prints what an archive, or an unfinished one (FILE.partial), holds: its progress, what became of its
designs, the optimum so far, where it comes from, and its job.

)";

po::options_description command_options(Command command) {
  po::options_description options("Options");
  auto add = options.add_options();
  add("help,h", "this text");
  if (command == Command::info) return options;
  if (command != Command::trace) {
    add("overwrite", command == Command::sweep
                         ? "replace the archive, or the unfinished one, that is there"
                         : "replace the archive that is there");
    add("progress", po::value<std::string>()->value_name("STYLE"),
        "on stderr: auto, bar, lines or none");
    if (command == Command::sweep)
      add("time-limit", po::value<std::string>()->value_name("TIME"),
          "stop by itself, with exit code 75, after seconds or [[days-]hours:]minutes:seconds");
  } else {
    const auto metres = [] { return po::value<std::string>()->value_name("M"); };
    add("r1", metres(), "counterweight's arm, m");
    add("r2", metres(), "throwing arm, m");
    add("r3", metres(), "sling, m");
    add("interval", po::value<std::string>()->value_name("S"),
        "time between rows, s; without it every step of a fixed stepper, else 0.01");
  }
  return options;
}

/// Whether a command uses a key. trace prints its table, and assess takes from [output] its file.
bool uses(Command command, const Key& key) {
  const std::string section = key.section();
  if (section == "scene" || section == "solver") return true;
  if (command == Command::trace) return false;
  if (command == Command::assess) return section != "output" || key.name == "output.file";
  return section != "assess";
}

po::options_description key_options(Command command) {
  po::options_description options("Keys of the job file, with their defaults");
  const Job defaults;
  options.add_options()(scene_file.c_str(), po::value<std::string>()->value_name("PATH"),
                        "file with keys of the scene, which override the job's");
  for (const Key& key : job_keys())
    if (uses(command, key))
      options.add_options()(
          key.name.c_str(),
          po::value<std::string>()->value_name(fmt::format("(={})", key.get(defaults))),
          key.help.c_str());
  return options;
}

std::string help_of(Command command) {
  const char* const help = command == Command::sweep    ? sweep_help
                           : command == Command::assess ? assess_help
                           : command == Command::info   ? info_help
                                                        : trace_help;
  std::ostringstream text;
  text << help << command_options(command);
  if (command != Command::info) text << "\n" << key_options(command);
  return text.str();
}

/// Parses what follows the command; texts only, so that every value is checked in one way.
po::variables_map parse_options(Command command, int argc, const char* const* argv) {
  po::options_description options;
  options.add(command_options(command));
  if (command != Command::info) options.add(key_options(command));
  options.add_options()("job", po::value<std::vector<std::string>>());
  po::positional_options_description positions;
  positions.add("job", -1);
  constexpr int exact =
      po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc - 1, argv + 1)
                  .options(options)
                  .positional(positions)
                  .style(exact)
                  .run(),
              given);
  } catch (const po::unknown_option& unknown) {
    throw InputError(fmt::format("{}: unknown option of {}; 'trebsweep {} --help' lists them",
                                 shortened(unknown.get_option_name()), argv[1], argv[1]));
  } catch (const po::error& error) {
    throw InputError(
        fmt::format("{}; see 'trebsweep {} --help'", shortened(error.what()), argv[1]));
  }
  return given;
}

double length(const po::variables_map& given, const std::string& name) {
  if (!given.count(name)) throw InputError("--" + name + ": missing; give its length in metres");
  return to_number(name, given[name].as<std::string>(), physical);
}

Command to_command(const std::string& name) {
  if (name == "sweep") return Command::sweep;
  if (name == "trace") return Command::trace;
  if (name == "assess") return Command::assess;
  if (name == "info") return Command::info;
  throw InputError(fmt::format(
      "{}: unknown command; the commands are sweep, trace, assess and info", shortened(name)));
}

ProgressStyle to_progress(const std::string& value) {
  const auto found = std::find(progress_names.begin(), progress_names.end(), value);
  if (found == progress_names.end())
    refuse("progress", value, fmt::format("one of {}", fmt::join(progress_names, ", ")));
  return static_cast<ProgressStyle>(found - progress_names.begin());
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  CommandLine line;
  line.help = general_help;
  if (argc < 2) throw InputError("no command given; try 'trebsweep --help'");
  const std::string first = argv[1];
  if (first == "--help" || first == "-h") return line;
  line.command = Command::version;
  if (first == "--version") return line;

  line.command = to_command(first);
  const po::variables_map given = parse_options(line.command, argc, argv);
  if (given.count("help")) {
    line.help = help_of(line.command);
    line.command = Command::help;
    return line;
  }
  const bool info = line.command == Command::info;
  if (!given.count("job"))
    throw InputError(info ? "no archive given" : "no job file given; try jobs/paper.cfg");
  const auto& files = given["job"].as<std::vector<std::string>>();
  if (files.size() > 1)
    throw InputError(fmt::format("{}: only one {} can be given", shortened(files[1]),
                                 info ? "archive" : "job file"));
  (info ? line.archive : line.job_file) = files[0];
  if (info) return line;
  for (const Key& key : job_keys())
    if (given.count(key.name)) line.overrides[key.name] = given[key.name].as<std::string>();
  if (given.count(scene_file)) line.overrides[scene_file] = given[scene_file].as<std::string>();

  if (line.command != Command::trace) {
    line.overwrite = given.count("overwrite") > 0;
    if (given.count("time-limit"))
      line.time_limit = to_seconds("time-limit", given["time-limit"].as<std::string>());
    if (given.count("progress")) line.progress = to_progress(given["progress"].as<std::string>());
  } else {
    line.design = {length(given, "r1"), length(given, "r3"), length(given, "r2")};
    if (given.count("interval"))
      line.interval = to_number("interval", given["interval"].as<std::string>(), positive);
  }
  return line;
}

}  // namespace trebsweep
