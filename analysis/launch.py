"""Finds trebsweep and runs it."""

import json
import os
import shutil
import subprocess
import sys

from program import fail, note

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAMS = (os.path.join(HERE, "..", "build", "release", "trebsweep"),  # built here
            os.path.join(HERE, "..", "..", "..", "bin", "trebsweep"))   # installed
PROGRAM_HELP = ("path of trebsweep (default: $TREBSWEEP, otherwise the one built or installed with "
                "this script, otherwise the one in PATH)")


def find_program(given=None):
    """The given program, else that of the environment, else the one built or installed with the
    scripts, else the one in PATH; ends the script if no program is found."""
    built = [os.path.normpath(path) for path in PROGRAMS if os.access(path, os.X_OK)]
    found = [given, os.environ.get("TREBSWEEP"), *built, shutil.which("trebsweep")]
    return next(filter(None, found), None) or fail(
        "trebsweep: no such program built or installed with this script, or in PATH; "
        "build it or give --program")


def run_program(program, *arguments, ranks=None):
    """A command that has ended, with what it printed, on some ranks of mpirun if these are given; ends
    the script if it cannot be started."""
    command = [*(("mpirun", "-n", str(ranks)) if ranks else ()), program, *arguments]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        fail(f"{command[0]}: cannot be started: {error.strerror}")


def words_of(done):
    """The words of a command that has ended, without mpirun."""
    return done.args[3:] if done.args[0] == "mpirun" else done.args


def check(done):
    """Ends the script with the message of a command that failed, and exit code 1 or 2 as it."""
    if done.returncode != 0:
        program, command = words_of(done)[:2]
        note(done.stderr or f"{program}: {command} failed with exit code {done.returncode}")
        sys.exit(2 if done.returncode == 2 else 1)


def parse_optimum(done):
    """The object that `trebsweep optimum --json` printed; ends the script if it failed."""
    check(done)
    try:
        return json.loads(done.stdout)
    except ValueError as error:
        fail(f"{words_of(done)[0]}: printed no optimum: {error}")
