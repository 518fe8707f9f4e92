#include "trebsweep/cli/help.hpp"

#include <sstream>

#include "trebsweep/cli/options.hpp"
#include "trebsweep/job/unit.hpp"

namespace trebsweep {
namespace {

const char* const sweep_help =
    R"(Usage: trebsweep sweep JOB [options]
       mpirun -n RANKS trebsweep sweep JOB [options]

Integrates every design (r1, r3, r2) of the job's lattice and writes maps of
the results to one HDF5 archive (output.file). The summary goes to stdout,
progress and warnings about doubtful results and optima that cannot be built go
to stderr. Until the archive is complete, its results are in a folder whose name
ends in .partial.

A key of [scene] with several numbers (first:last:step, or a list) makes the
sweep a study: it visits every combination of such keys, the maps have their
axes first, and the optimum of each scene is stored as well. With
output.maps = none nothing else is stored.

To continue an interrupted sweep, run the same command again, on any number of
ranks; a killed sweep loses only its last few seconds. Tiles that do not match
their checksums are computed again. SIGINT (Ctrl-C), SIGTERM, SIGUSR1 and
--time-limit stop a sweep after the tiles in progress, with exit code 75.

)";

const char* const optimum_help =
    R"(Usage: trebsweep optimum JOB [options]
       mpirun -n RANKS trebsweep optimum JOB [options]

Searches for the design with the largest optimum.objective that satisfies
optimum.subject-to, for lengths r1, r3 and r2 within the bounds of the job's
lattice; a length with a single value is kept. A coarse sweep finds local maxima,
from the best of which continuous searches start. The spacing of the coarse sweep
is chosen, unless --lattice.increment gives it. Every design is integrated
accurately, by vern8, whatever the job's stepper; the release window becomes a
crossing. jobs/README.md explains the output.

With optimum.variables, keys of the scene, pin-angle or release-angle are
searched as well. The coarse sweep then has up to 300,000 designs in all, fewer
where swings take long: scenes from one Sobol sequence and, in each scene, lengths
from another. --lattice.increment is then not used.

--pareto "A, B" prints the front of two objectives instead: the largest A for B
at equal distances, and the multiplier, how A changes along the front with B.

Prints the optimum with its error, determined in extended precision; the limits
that it reaches and how much the optimum grows with each; how far each length may
be off before 1 % of the value is lost; with optimum.deviation the worst and the
expected value of designs whose lengths are off by up to that; the number of
local maxima and the next best; and the change of the value with each key of the
scene, for the same lengths and for those that are then optimal.

)";

const char* const trace_help =
    R"(Usage: trebsweep trace JOB --r1 NUMBER --r2 NUMBER --r3 NUMBER [options]

Integrates one design from rest to its release and prints the swing as a table
to stdout: comment lines (#) with the heights of fulcrum and trough, the release
rule, the times of lift-off and release, and where and when the swing is closest
to the ground and the tensions of sling and hanger are least, then a header and a
row per time. A warning on stderr says in what the design cannot be built.
Positions are relative to the fulcrum. The columns are
  t            time, s
  phi1         angle of the counterweight arm from the upward vertical,
               clockwise, rad
  phi2         angle of the sling from the downward vertical, clockwise, rad
  w1 w2        angular velocities of phi1 and phi2, rad/s
  phi3 w3      with a hanger: its angle from the downward vertical, clockwise,
               rad, and its angular velocity, rad/s
  x1 y1        position of the counterweight, m
  xh yh        with a hanger: position of its hinge at the end of the
               counterweight arm, m
  xt yt        position of the tip of the throwing arm, m
  x3 y3        position of the projectile, m
  speed        speed of the projectile, m/s
  energy       kinetic, potential and elastic energy, J
  tension      force of the sling on the projectile, N; negative where a rigid
               sling would be under compression
  tip_tension  force of the sling on the tip of the throwing arm, N; differs
               from tension if the sling has mass
  axle         force on the axle, N
  stress       magnitude of the bending stress at the fulcrum, Pa; left out if
               the cross-section of the beam is not known
  hanger_tension
               with a hanger: its force on the counterweight, N; negative
               where it would be under compression
  normal       with a trough: its force on the projectile, N; 0 after the
               lift-off

With --flight, prints the flight from the release to the ground instead. The
columns are
  t            time since the start of the swing, s
  x3 y3        position of the projectile, m
  vx vy        horizontal and vertical velocity of the projectile, m/s
  speed        speed of the projectile, m/s

)";

const char* const assess_help =
    R"(Usage: trebsweep assess JOB [options]
       mpirun -n RANKS trebsweep assess JOB [options]

Compares steppers on a sample of the designs of each scene in
assess.scenes, with references in extended precision: error, steps and run time
of each setting, order of convergence, largest stable step, error over the whole
lattice, and the cheapest solver for a target error. The tables go to stdout and
to the archive (output.file, by default JOB-assess.h5), where each is a group
that xarray can open.

)";

const char* const info_help =
    R"(Usage: trebsweep info FILE [--verify | --snapshot PATH]

Prints a description of an archive, or of an unfinished sweep, FILE.partial: its
progress, the number of designs of each status, the optimum so far, its
provenance and its job. If FILE does not exist, FILE.partial is described.

With --verify, reads all maps instead and compares each tile with its checksums.
Prints the maps and tiles that are damaged; the exit code is then 1.

With --snapshot, writes what is done of an unfinished sweep as an archive. Designs
that are not done are NaN there.

)";

/// The names of all units, in lines of up to 80 characters.
std::string wrapped_unit_names() {
  std::string text = unit_names();
  constexpr std::size_t width = 80;
  for (std::size_t line = 0; text.size() - line > width;) {
    const std::size_t space = text.rfind(' ', line + width);
    text[space] = '\n';
    line = space + 1;
  }
  return text;
}

}  // namespace

std::string general_help() {
  return R"(trebsweep explores the design space of a trebuchet.

Usage:
  trebsweep sweep JOB [options]   integrate every design of a lattice and write
                                  maps of the results to an HDF5 archive
  trebsweep optimum JOB [options] find the best design, within limits, and how
                                  precisely to build it
  trebsweep trace JOB --r1 NUMBER --r2 NUMBER --r3 NUMBER [options]
                                  print the swing of one design as a table, or
                                  with --flight the flight after it
  trebsweep assess JOB [options]  measure the error, run time and stability of
                                  the steppers (integration methods)
  trebsweep info FILE [--verify]  describe an archive, or verify its checksums
  trebsweep COMMAND --help        describe a command, its options and keys
  trebsweep --version             print the version and the instruction set

sweep, optimum and assess run in parallel: mpirun -n RANKS trebsweep sweep JOB

JOB is a text file with keys and values; jobs/paper.cfg shows all of them. If it
is -, the job is read from stdin, and its archive is called job.h5 or, of assess,
job-assess.h5, unless output.file names it. Every key is also an option, which
takes precedence: --solver.tolerance 1e-9. Numbers are in SI units, or in the one
that follows: --scene.beam-side "9.5 cm", 132lb, "40 lb/ft^3". The units are
)" + wrapped_unit_names() +
         R"(
and products of their powers. The value of a scene key is taken from
the first of these that sets it:
  1. the option --scene.KEY
  2. the file named by the option --scene.file
  3. the section [scene] of the job file
  4. the file named by the key file in that section
  5. the default

Exit codes:
   0  complete
   1  run-time error
   2  invalid command line or job file; nothing was written
  75  stopped before the end; run the same command again to continue
)";
}

std::string command_help(Command command) {
  std::ostringstream text;
  text << (command == Command::sweep     ? sweep_help
           : command == Command::optimum ? optimum_help
           : command == Command::assess  ? assess_help
           : command == Command::info    ? info_help
                                         : trace_help)
       << command_options(command);
  if (command != Command::info)
    text << "\nThe keys of the job file are options as well.\n" << key_options(command);
  return text.str();
}

}  // namespace trebsweep
