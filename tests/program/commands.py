"""Shared by the tests of commands."""

import os

import numpy as np

from support import PROGRAM, DirectoryTest

KERNELS = os.path.join(os.path.dirname(PROGRAM), "lib", "glibc-hwcaps")
COARSE = ("--lattice.increment", "0.1")
SMALL_ASSESSMENT = ("--assess.steppers", "euler, dopri5, rosenbrock4", "--assess.time-steps", "0.01, 0.005",
                    "--assess.tolerances", "1e-5, 1e-8", "--assess.designs", "3", "--assess.repeats", "1",
                    "--lattice.increment", "0.25")
DESIGN = ("--r1", "0.51", "--r2", "0.91", "--r3", "0.58")


def read_trace(text):
    """The comments of a trace, {key: text}, and its rows, an array with the names of the columns."""
    lines = text.splitlines()
    comments = dict(line[2:].split(" = ") for line in lines if line.startswith("# "))
    return comments, np.genfromtxt([line for line in lines if line[0] != "#"], names=True)


def wide_kernels():
    """Whether there are kernels for AVX2 and AVX-512, and the machine can run both."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return "avx512dq" in file.read() and all(os.path.isdir(os.path.join(KERNELS, level))
                                                 for level in ("x86-64-v3", "x86-64-v4"))


class CommandTest(DirectoryTest):
    """Tests that start with a job file alone in their directory."""

    def setUp(self):
        self.empty_directory()
        self.job = self.write("job.cfg", "[solver]\nstepper = dopri5\nrelease = crossing\n")

    def assert_refused(self, arguments, *words):
        """Exit code 2, one line on stderr that holds the words, and no change of the directory."""
        before = self.snapshot()
        done = self.run_program(*arguments, code=2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assert_one_message(done.stderr, *words)
        self.assertEqual(self.snapshot(), before)

    def redirected(self, redirection, *command, code=0):
        """Runs a command with a redirection of bash."""
        return self.run_command("bash", "-c", f'exec "$@" {redirection}', "bash", *command, code=code)

    def snapshot(self):
        """{name: bytes} of the regular files in the directory."""
        return {name: self.read(name) for name in os.listdir(self.directory) if os.path.isfile(self.path(name))}
