"""Shared by the Python tests: the program, its launcher, and a temporary directory for each test class.

TREBSWEEP (the program) and MPIEXEC (mpirun) come from the environment; ctest sets them.
"""

import os
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
JOBS = os.path.join(REPOSITORY, "jobs")
PROGRAM = os.environ.get("TREBSWEEP", os.path.join(REPOSITORY, "build", "release", "trebsweep"))
MPIEXEC = os.environ.get("MPIEXEC", "mpirun")

# Open MPI keeps its session files in TMPDIR. Programs without mpirun share one session directory there, which the
# first that ends removes: tests that run at the same time need different ones.
SESSIONS = tempfile.TemporaryDirectory(prefix="trebsweep_")
os.environ["TMPDIR"] = SESSIONS.name


def mpirun(ranks):
    """The launcher's words for a number of ranks; none for None, which starts the program alone."""
    return [MPIEXEC, "-n", str(ranks)] if ranks else []


class DirectoryTest(unittest.TestCase):
    """Tests that share a temporary directory, in which the programs run."""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory(prefix="trebsweep_")
        cls.addClassCleanup(directory.cleanup)
        cls.directory = directory.name

    def empty_directory(self):
        """Removes whatever earlier tests left in the directory."""
        shutil.rmtree(self.directory)
        os.mkdir(self.directory)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.directory, name)

    @classmethod
    def write(cls, name, content):
        """Writes a file of text or bytes; returns its path."""
        data = content if isinstance(content, (bytes, bytearray)) else content.encode()
        with open(cls.path(name), "wb") as file:
            file.write(data)
        return cls.path(name)

    @classmethod
    def read(cls, name):
        """The bytes of a file."""
        with open(cls.path(name), "rb") as file:
            return file.read()

    def assert_one_message(self, stderr, *words):
        """The program prints exactly one message of its own, which contains the words."""
        messages = [line for line in stderr.splitlines() if line.startswith("trebsweep: ")]
        self.assertEqual(len(messages), 1, stderr)
        for word in words:
            self.assertIn(word, messages[0])

    def run_command(self, *command, code=0, timeout=120, **variables):
        """Runs a command to its end. `code` is the expected exit code, None for any; `variables` are added to
        the environment."""
        done = subprocess.run(command, cwd=self.directory, text=True, capture_output=True, timeout=timeout,
                              check=False, env={**os.environ, **variables})
        if code is not None:
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def run_program(self, *arguments, ranks=None, code=0, environment=None):
        """Runs trebsweep, under mpirun if `ranks` is given."""
        return self.run_command(*mpirun(ranks), PROGRAM, *arguments, code=code, **(environment or {}))
