"""Options, messages and exit codes of treb-plot.

Exit codes: 0 success; 1 a file, a module or a program is missing or unusable; 2 bad command line.
Every failure is reported as one line on stderr. In Python it is an Error.
"""

import argparse
import contextlib
import os
import re
import signal
import sys
from typing import NoReturn


class Error(Exception):
    """What cannot be done, in one line, and the exit code of treb-plot: 2 if an argument is wrong, else 1."""

    def __init__(self, message, code=1):
        super().__init__(" ".join(str(message).split()))
        self.code = code


def note(message):
    """Prints a line on stderr; line breaks in the message become spaces. Failures are ignored."""
    if sys.stderr:  # otherwise it is closed, and print would use stdout
        with contextlib.suppress(OSError):
            print(" ".join(str(message).split()), file=sys.stderr)


def key_of(dataset: str) -> str:
    """The key or the field of the job file that a dataset is named after."""
    return dataset.replace("_", "-")


def fail(message: object, code: int = 1) -> NoReturn:
    """Raises an Error."""
    raise Error(message, code)


def refuse(option: str, value: object, allowed: str) -> NoReturn:
    """Raises an Error with an option, its value and what is allowed."""
    raise Error(f"{option} = {value}: {allowed}", 2)


def check_output(option, path, inputs, may_replace, advice):
    """Refuses an option if writing `path` would overwrite one of the inputs,
    something that is not a file, or any file unless `may_replace`; `advice` then says why."""
    refuse_overwriting(option, path, *inputs)
    if os.path.exists(path) and not os.path.isfile(path):
        refuse(option, path, "is not a regular file; name another file")
    if os.path.lexists(path) and not may_replace:
        refuse(option, path, advice)


def check_new(option, path, overwrite, *inputs):
    """The same for a file that is replaced only with --overwrite."""
    check_output(option, path, inputs, overwrite, "exists; name another file, or give --overwrite")


def write_text(path, text):
    """Writes a file that was checked; if that fails, an older file is kept."""
    path = os.path.realpath(path)
    new = f"{path}.{os.getpid()}.new"
    try:
        with open(new, "x", encoding="utf-8") as file:
            file.write(text)
        os.replace(new, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.remove(new)
        fail(f"{path}: cannot be written: {error.strerror}")


def refuse_overwriting(option, path, *inputs):
    """Refuses an option if writing `path` would overwrite one of its inputs."""
    for name in inputs:
        for file in (name, existing(name)):
            if os.path.realpath(path) == os.path.realpath(file) or (
                    os.path.exists(path) and os.path.exists(file) and os.path.samefile(path, file)):
                refuse(option, path, "must not be an input file")


def existing(path):
    """The path of an archive, or that of its unfinished sweep if only this one exists."""
    partial = (os.path.realpath(path) if os.path.islink(path) else path) + ".partial"
    return partial if not os.path.exists(path) and os.path.exists(partial) else path


def assignment(text):
    """(key, number) of KEY=VALUE."""
    key, _, value = text.partition("=")
    try:
        return key.strip(), float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: must be KEY=VALUE, VALUE a number") from None


def interval(text):
    """(key, (first, last)) of KEY=FIRST:LAST or KEY=VALUE."""
    key, _, ends = text.partition("=")
    try:
        first, *last = map(float, ends.split(":"))
        if len(last) < 2 and first <= (last or [first])[0]:
            return key.strip(), (first, (last or [first])[0])
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(f"{text}: must be KEY=FIRST:LAST with FIRST <= LAST")


class Parser(argparse.ArgumentParser):
    """A parser that prints a module's docstring as its help, and each error as one line. Words of options may be
    joined by - or _ alike."""

    def __init__(self, doc):
        super().__init__(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)

    def parse_args(self, args=None, namespace=None):
        words = sys.argv[1:] if args is None else args
        return super().parse_args([re.sub(r"^--[^=]*", lambda option: option[0].replace("_", "-"), word)
                                   for word in words], namespace)

    def add_scene(self, option="--at", what="the scene to read from the archive of a study"):
        """Adds an option that selects scenes: pairs (key, value) of outer axes."""
        self.add_argument(option, metavar="KEY=VALUE", type=assignment, action="append", default=[],
                          help=f"{what}: the value of an outer axis, such as projectile-mass=100; "
                               "once per outer axis")

    def add_overwrite(self):
        """Adds the option without which no existing file is replaced."""
        self.add_argument("--overwrite", action="store_true", help="replace an existing file")

    def error(self, message):
        note(f"{self.prog}: {message}; see {self.prog} --help")
        sys.exit(2)


def is_hdf5(path):
    """Whether a file has the signature of HDF5."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


@contextlib.contextmanager
def limited_cpu_time(seconds=20):
    """Ends the program if HDF5 loops on a damaged file; waiting for a disk does not count."""
    signal.setitimer(signal.ITIMER_PROF, seconds)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0)


def run(main):
    """Runs `main` in a child process, because HDF5 crashes on some damaged files, and exits."""
    child = os.fork()
    if child == 0:
        sys.stdout.reconfigure(errors="surrogateescape")  # file names may hold any bytes
        sys.exit(code_of(main))
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status):
        number = signal.Signals(os.WTERMSIG(status))
        files = " or ".join(filter(is_hdf5, map(existing, sys.argv[1:])))
        note("was killed; is there enough memory?" if number == signal.SIGKILL else
             f"{files}: damaged, or not written by trebsweep: HDF5 crashed with {number.name}")
        sys.exit(1)
    sys.exit(os.WEXITSTATUS(status))


def code_of(main):
    """Runs `main`; prints its failure as one line, unless it is a bug, and returns the exit code."""
    try:
        try:
            main()
        finally:
            sys.stdout.flush()
        return 0
    except BrokenPipeError:  # the reader has left, as in `treb-plot study ... --csv | head -1`
        os._exit(128 + signal.SIGPIPE)
    except Error as error:
        note(error)
        return error.code
    except OSError as error:
        note(f"{error.filename}: {error.strerror}" if error.filename else error)
    except ImportError as error:
        note(f"treb-plot: {sys.executable} cannot import {error.name}; install h5py, matplotlib, pandas and xarray "
             "(Debian: python3-h5py, python3-matplotlib, python3-xarray), or use a python3 that has them, such as "
             "/usr/bin/python3")
    except MemoryError:
        note("out of memory")
    except KeyboardInterrupt:
        pass
    return 1
