"""Options, messages and exit codes of the scripts.

Exit codes: 0 success; 1 a file, a module or a program is missing or unusable; 2 bad command line.
Every failure is reported as one line on stderr. Import this module first: it also reports missing
modules.
"""

import argparse
import contextlib
import os
import signal
import sys

NAME = os.path.basename(sys.argv[0])


def note(message):
    """Prints a line on stderr; line breaks in the message become spaces. Failures are ignored."""
    if sys.stderr:  # otherwise it is closed, and print would use stdout
        with contextlib.suppress(OSError):
            print(" ".join(str(message).split()), file=sys.stderr)


def fail(message):
    """Ends the program with exit code 1 and a message."""
    note(message)
    sys.exit(1)


def refuse(option, value, allowed):
    """Ends the program with exit code 2 and an option, its value and what is allowed."""
    note(f"{option} = {value}: {allowed}")
    sys.exit(2)


def check_output(option, path, inputs, may_replace, advice):
    """Ends the program with exit code 2 if writing `path` would overwrite one of the inputs,
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
    """Writes a file that was checked; ends the program if that fails, and then keeps an older file."""
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
    """Ends the program with exit code 2 if writing `path` would overwrite one of its inputs."""
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
    """A parser that prints the script's docstring as its help, and each error as one line."""

    def __init__(self, doc):
        super().__init__(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)

    def add_scene(self, option="--at", what="the scene to read from the archive of a study"):
        """Adds an option that selects scenes: pairs (key, value) of outer axes."""
        self.add_argument(option, metavar="KEY=VALUE", type=assignment, action="append", default=[],
                          help=f"{what}: the value of an outer axis, such as projectile-mass=100; "
                               "once per outer axis")

    def add_overwrite(self):
        """Adds the option without which no existing file is replaced."""
        self.add_argument("--overwrite", action="store_true", help="replace an existing file")

    def error(self, message):
        note(f"{NAME}: {message}; see {NAME} --help")
        sys.exit(2)


def is_hdf5(path):
    """Whether a file has the signature of HDF5."""
    if not os.path.isfile(path):
        return False
    with open(path, "rb") as file:
        return file.read(8) == b"\x89HDF\r\n\x1a\n"


def run(main):
    """Runs `main` in a child process, because HDF5 crashes on some damaged files."""
    child = os.fork()
    if child == 0:
        sys.stdout.reconfigure(errors="surrogateescape")  # file names may hold any bytes
        try:
            try:
                main()
            finally:
                sys.stdout.flush()
        except BrokenPipeError:  # the reader has left, as in `study.py ... --csv | head -1`
            os._exit(128 + signal.SIGPIPE)
        sys.exit()
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL:
        fail(f"{NAME}: was killed; is there enough memory?")
    if os.WIFSIGNALED(status):
        files = " or ".join(filter(is_hdf5, map(existing, sys.argv[1:])))
        fail(f"{files}: damaged, or not written by trebsweep: HDF5 crashed with "
             f"{signal.Signals(os.WTERMSIG(status)).name}")
    sys.exit(os.WEXITSTATUS(status))


def report(kind, error, traceback):
    """Prints an uncaught exception, as one line unless it is a bug in the scripts."""
    if issubclass(kind, ImportError):
        note(f"{NAME}: {sys.executable} cannot import {error.name or 'a module'}; install h5py, "
             f"matplotlib and numpy (Debian: python3-h5py, python3-matplotlib), or use a python3 "
             f"that has them, such as /usr/bin/python3 {sys.argv[0]}")
    elif issubclass(kind, OSError):
        note(f"{error.filename}: {error.strerror}" if error.filename else error)
    elif issubclass(kind, MemoryError):
        note(f"{NAME}: out of memory")
    elif not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, traceback)


sys.excepthook = report
