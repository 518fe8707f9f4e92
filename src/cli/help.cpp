#include "trebsweep/cli/help.hpp"

#include <fmt/format.h>

#include <array>
#include <sstream>

#include "trebsweep/cli/exit_code.hpp"
#include "trebsweep/cli/options.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

constexpr CommandText sweep_text{
    "trebsweep sweep JOB [options]",
    "integrate every design of a lattice and write maps of the results",
    R"(Integrates every design (r1, r3, r2) of the job's lattice and writes maps of the results to one
HDF5 archive. The summary goes to stdout; progress and warnings about doubtful results and optima
that cannot be built go to stderr. Until the archive is complete, its results are in the folder
FILE.partial.

A key of [scene] with several numbers (first:last:step, or a list) makes the sweep a study: it
visits every combination of such keys, the maps have their axes first, and the optimum of each scene
is stored as well. With output.maps = none nothing else is stored.

To continue an interrupted sweep, run the same command again, on any number of ranks; a killed sweep
loses only its last few seconds. SIGINT (Ctrl-C), SIGTERM, SIGUSR1 and --time-limit stop a sweep
after the tiles in progress, with exit code 75.
)"};

constexpr CommandText optimum_text{
    "trebsweep optimum JOB [options]",
    "find the best design, within limits, and how precisely to build it",
    R"(Searches for the design with the largest optimum.objective that satisfies optimum.subject-to, for
lengths within the bounds of the job's lattice; a length with a single value is kept. With
optimum.variables, keys of the scene, pin-angle or release-angle are searched as well. A coarse
sweep finds local maxima, from the best of which continuous searches start. Its spacing is chosen,
unless --lattice.increment gives it. Every design is integrated accurately, by vern8, whatever the
job's stepper; the release window becomes a crossing.

Prints the optimum with its error; the limits that it reaches and how much it grows with each; how
far each length may be off before 1 % of the value is lost; with optimum.deviation the worst and the
expected value of designs whose lengths are off by up to that; the next best local maxima; and how
the value changes with each key of the scene. jobs/README.md explains the output.
)"};

constexpr CommandText trace_text{
    "trebsweep trace JOB --r1 NUMBER --r2 NUMBER --r3 NUMBER [options]",
    "print the swing of one design, or the flight after it, as a table",
    R"(Integrates one design from rest to its release and prints the swing as a table: comments (#) with
heights, release, lift-off and the least clearances and tensions, a header, and a row per time. A
warning on stderr says in what the design cannot be built. Positions are relative to the fulcrum, in
m; angles are clockwise, in rad; forces in N.

  t            time, s
  phi1 phi2    angles of the counterweight arm from the upward vertical, of the sling from the lower
  w1 w2        angular velocities of phi1 and phi2, rad/s
  phi3 w3      with a hanger: its angle from the downward vertical, and its angular velocity
  x1 y1        position of the counterweight
  xh yh        with a hanger: position of its hinge, at the end of the counterweight arm
  xt yt        position of the tip of the throwing arm
  x3 y3        position of the projectile
  speed        speed of the projectile, m/s
  energy       kinetic, potential and elastic energy, J
  tension      force of the sling on the projectile; negative where a rigid sling is compressed
  tip_tension  force of the sling on the tip of the arm; differs if the sling has mass
  axle         force on the axle
  stress       bending stress at the fulcrum, Pa; left out if the beam's cross-section is unknown
  hanger_tension  with a hanger: its force on the counterweight; negative under compression
  normal       with a trough: its force on the projectile; 0 after the lift-off
  vx vy        with --flight, after t and x3 y3: velocity of the projectile, m/s; then speed
)"};

constexpr CommandText assess_text{
    "trebsweep assess JOB [options]", "measure the error, run time and stability of the steppers",
    R"(Compares steppers (integration methods) on a sample of the designs of each scene in assess.scenes,
with references in extended precision: error, steps and run time of each setting, order of
convergence, largest stable step, error over the whole lattice, and the cheapest solver for a target
error. The tables go to stdout and to the archive (by default JOB-assess.h5), where each is a group
that xarray can open.
)"};

constexpr CommandText info_text{
    "trebsweep info FILE [options]", "describe an archive, or verify its checksums",
    R"(Describes an archive, or an unfinished sweep, FILE.partial: its progress, the number of designs of
each status, the optimum so far, its provenance and its job. If FILE does not exist, FILE.partial is
described.

With --verify, reads all maps instead and compares each tile with its checksums. Prints the maps and
tiles that are damaged; the exit code is then 1.

With --snapshot, writes what is done of an unfinished sweep as an archive. Designs that are not done
are NaN there.
)"};

/// The words of a text in lines of up to 100 characters; those after the first are indented.
std::string wrapped(std::string text, std::size_t indent) {
  constexpr std::size_t width = 100;
  for (std::size_t line = 0; text.size() - line > width;) {
    const std::size_t space = text.rfind(' ', line + width);
    text.replace(space, 1, "\n" + std::string(indent, ' '));
    line = space + 1;
  }
  return text;
}

/// The names of the keys that a command uses, a paragraph for each section.
std::string key_names(Command command) {
  std::string text;
  for (const std::string_view section : job_sections) {
    std::string names = section == "scene" ? " file" : "";
    for (const Key& key : job_keys())
      if (key.section() == section && uses(command, key))
        names += " " + key.name.substr(section.size() + 1);
    if (names.size() > 0) text += wrapped(fmt::format("  {:9}{}", section, names), 12) + "\n";
  }
  return text;
}

}  // namespace

const CommandText& text_of(Command command) {
  static constexpr std::array texts{&sweep_text, &optimum_text, &trace_text, &assess_text,
                                    &info_text};
  return *texts.at(static_cast<std::size_t>(command));
}

std::string job_text() {
  return R"(sweep, optimum and assess run in parallel: mpirun -n RANKS trebsweep sweep JOB

JOB is a text file with keys and values; jobs/paper.cfg shows all of them. If it is -, the job is
read from stdin, and its archive is called job.h5 or, of assess, job-assess.h5, unless output.file
names it. Every key is also an option, which takes precedence: --solver.tolerance 1e-9. The value of
a scene key is taken from the first of these that sets it:

  1. the option --scene.KEY
  2. the file named by the option --scene.file
  3. the section [scene] of the job file
  4. the file named by the key file in that section
  5. the default

Numbers are in SI units, or in the one that follows: "9.5 cm", 132lb, "40 lb/ft^3".
)" + wrapped("Units: " + unit_names() + " and products of their powers.", 0) +
         "\n";
}

std::string general_help() {
  std::string text = "trebsweep explores the design space of a trebuchet.\n\nUsage:\n";
  for (std::size_t c = 0; c < command_names.size(); ++c)
    text += fmt::format("  trebsweep {:9} {} {}\n", command_names[c],
                        command_names[c] == "info" ? "FILE  " : "JOB   ",
                        text_of(static_cast<Command>(c)).brief);
  text +=
      R"(  trebsweep help [COMMAND]   describe a command and its options, as COMMAND --help does
  trebsweep COMMAND --help-keys   describe the keys of the job file
  trebsweep completion       print a script that completes commands and options in bash
  trebsweep --version        print the version and the instruction set

)" + job_text() +
      "\nExit codes:\n";
  for (const auto& [code, meaning] : exit_code::all)
    text += fmt::format("  {:2}  {}\n", code, meaning);
  return text;
}

std::string command_help(Command command) {
  const auto& [usage, brief, about] = text_of(command);
  std::ostringstream text;
  text << "Usage: " << usage << '\n';
  if (command == Command::sweep || command == Command::optimum || command == Command::assess)
    text << "       mpirun -n RANKS " << usage << '\n';
  text << '\n' << about << '\n' << shown_options(command);
  if (command != Command::info)
    text << "\nKeys of the job file, which are options as well, --scene.gravity NUMBER; "
            "--help-keys describes them:\n"
         << key_names(command);
  return text.str();
}

std::string key_help(Command command) {
  std::ostringstream text;
  text << "The keys of the job file, which are options of trebsweep "
       << command_names[static_cast<std::size_t>(command)] << " as well.\n"
       << key_options(command);
  return text.str();
}

}  // namespace trebsweep
