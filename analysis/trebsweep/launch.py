"""Finds trebsweep and runs it."""

from __future__ import annotations

import functools
import json
import os
import re
import shutil
import subprocess
import tempfile
from typing import Any

from .program import Error, fail, refuse, write_text

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAMS = (os.path.join(HERE, "..", "..", "build", "release", "trebsweep"),      # built here
            os.path.join(HERE, "..", "..", "..", "..", "bin", "trebsweep"))       # installed
PROGRAM_HELP = ("path of trebsweep (default: $TREBSWEEP, otherwise the one built or installed with "
                "this package, otherwise the one in PATH)")


def find_program(given: str | None = None) -> str:
    """The given program, else that of the environment, else the one built or installed with the
    package, else the one in PATH."""
    built = [os.path.normpath(path) for path in PROGRAMS if os.access(path, os.X_OK)]
    found = [given, os.environ.get("TREBSWEEP"), *built, shutil.which("trebsweep")]
    return next(filter(None, found), "") or fail(
        "trebsweep: no such program built or installed with this package, or in PATH; "
        "build it or give --program")


def run_program(program: str, *arguments: str, ranks: int | None = None) -> subprocess.CompletedProcess:
    """A command that has ended, with what it printed, on some ranks of mpirun if these are given."""
    mpirun = os.environ.get("MPIEXEC", "mpirun")
    command = [*((mpirun, "-n", str(ranks)) if ranks else ()), program, *arguments]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        return fail(f"{command[0]}: cannot be started: {error.strerror}")


def words_of(done: subprocess.CompletedProcess) -> list[str]:
    """The words of a command that has ended, without mpirun."""
    return done.args[3:] if done.args[1] == "-n" else done.args


def checked(done: subprocess.CompletedProcess) -> str:
    """What a command that has ended printed; if it failed, its message is raised, with exit code 1 or 2 as it."""
    if done.returncode != 0:
        raise Error(done.stderr or f"{': '.join(words_of(done)[:2])} failed with exit code {done.returncode}",
                    2 if done.returncode == 2 else 1)
    return done.stdout


def parse_optimum(done: subprocess.CompletedProcess) -> dict[str, Any]:
    """The object that `trebsweep optimum --json` printed."""
    try:
        return json.loads(checked(done))
    except ValueError as error:
        return fail(f"{words_of(done)[0]}: printed no optimum: {error}")


@functools.lru_cache
def known_keys(program: str, command: str) -> list[str]:
    """The options of a command that are keys of the job file: "scene.gravity", ..."""
    return re.findall(r"(?m)^  (?:-o \[ )?--(\w+\.[\w-]+)", checked(run_program(program, command, "--help-keys")))


def options(program: str, command: str, keys: dict[str, Any]) -> list[str]:
    """Keys as options: projectile_mass=50 is --scene.projectile-mass=50. A key that two sections have is given with
    its section: output_file="a.h5". A list is several values."""
    words = []
    for name, value in keys.items():
        key = name.replace("_", "-")
        found = [known for known in known_keys(program, command)
                 if key in (known.split(".")[1], known.replace(".", "-"))]
        if len(found) != 1:
            refuse(name, value, f"must be a key of trebsweep {command}, such as projectile_mass or output_file"
                   + (f", one of {', '.join(found)}" if found else ""))
        text = ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)
        words.append(f"--{found[0]}={text}")
    return words


def command(name: str, job: str, *arguments: str, ranks: int | None = None, program: str | None = None,
            **keys: Any) -> subprocess.CompletedProcess:
    """Runs a command of trebsweep with a job, the path or the text of a job file."""
    found = find_program(program)
    with tempfile.TemporaryDirectory() as directory:
        if "\n" in job:
            text, job = job, os.path.join(directory, "job.cfg")
            write_text(job, text)
        return run_program(found, name, job, *arguments, *options(found, name, keys), ranks=ranks)
